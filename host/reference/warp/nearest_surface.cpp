/// @file nearest_surface.cpp
/// Counts faces, and finds nearest points by the stationary point of every face of a triangle.
#include "host/reference/warp/nearest_surface.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <set>

#include "host/reference/linear/least_norm.hpp"

namespace tetwarp::reference {
namespace {
/// The point of the plane, line or point through some corners that is nearest to x, as weights of
/// all three; nothing where one of the weights is negative.
std::optional<Eigen::Vector3d> stationary_weights(const Eigen::Matrix3d& corners,
                                                  const std::vector<int>& used,
                                                  const Eigen::Vector3d& x) {
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();
  const auto edges = static_cast<Eigen::Index>(used.size()) - 1;
  Eigen::MatrixXd span(3, edges);
  for (Eigen::Index e = 0; e < edges; ++e) {
    span.col(e) = corners.col(used[static_cast<std::size_t>(e) + 1]) - corners.col(used[0]);
  }
  Eigen::VectorXd along = Eigen::VectorXd::Zero(edges);
  if (edges > 0) along = least_norm_solution(span, x - corners.col(used[0]));
  weights(used[0]) = 1 - along.sum();
  for (Eigen::Index e = 0; e < edges; ++e)
    weights(used[static_cast<std::size_t>(e) + 1]) = along(e);
  if (!(weights.minCoeff() >= 0)) return std::nullopt;
  return weights;
}

/// Faces of tetrahedra that only one of them has; the same tetrahedron twice is one.
std::vector<std::array<std::int32_t, 3>> surface_of(const Mesh& mesh) {
  std::set<std::array<std::int32_t, 4>> tets;
  for (std::array<std::int32_t, 4> tet : mesh.tets) {
    std::sort(tet.begin(), tet.end());
    tets.insert(tet);
  }
  std::map<std::array<std::int32_t, 3>, int> count;
  for (const auto& tet : tets) {
    for (std::size_t left_out = 0; left_out < 4; ++left_out) {
      std::array<std::int32_t, 3> face{};
      std::size_t n = 0;
      for (std::size_t node = 0; node < 4; ++node) {
        if (node != left_out) face[n++] = tet[node];
      }
      ++count[face];
    }
  }
  std::vector<std::array<std::int32_t, 3>> faces;
  for (const auto& [face, times] : count) {
    if (times == 1) faces.push_back(face);
  }
  return faces;
}
}  // namespace

NearestSurface::NearestSurface(const WarpPlan& plan,
                               const Ownership& owners,
                               const double* rest,
                               const double* deformed)
    : to_world_(owners.output.to_world),
      falls_(plan.options.outside == Outside::falloff),
      reach_(plan.options.falloff) {
  for (const auto& face : surface_of(plan.mesh)) {
    Triangle triangle;
    for (int corner = 0; corner < 3; ++corner) {
      const auto n = static_cast<std::size_t>(face[static_cast<std::size_t>(corner)]);
      const Quanta quanta = owners.output.quanta_of(deformed + 3 * n);
      Eigen::Vector3d index;
      for (int axis = 0; axis < 3; ++axis) {
        index(axis) = static_cast<double>(quanta[static_cast<std::size_t>(axis)]) / one_voxel;
      }
      triangle.at.col(corner) = to_world_ * index;
      triangle.to_rest.col(corner) = Eigen::Map<const Eigen::Vector3d>(rest + 3 * n) -
                                     owners.output.origin - triangle.at.col(corner);
    }
    triangles_.push_back(triangle);
  }
}

Eigen::Vector3d NearestSurface::displacement(const Eigen::Vector3d& index) const {
  static const std::vector<std::vector<int>> faces{{0},    {1},    {2},      {0, 1},
                                                   {0, 2}, {1, 2}, {0, 1, 2}};
  const Eigen::Vector3d x = to_world_ * index;
  double least = std::numeric_limits<double>::infinity();
  Eigen::Vector3d found = Eigen::Vector3d::Zero();
  for (const Triangle& triangle : triangles_) {
    for (const std::vector<int>& face : faces) {
      const auto weights = stationary_weights(triangle.at, face, x);
      if (!weights) continue;
      const double distance = (triangle.at * *weights - x).norm();
      if (distance >= least) continue;
      least = distance;
      found = triangle.to_rest * *weights;
    }
  }
  if (!falls_) return found;
  const double t = least / reach_;
  return t < 1 ? Eigen::Vector3d((1 - 3 * t * t + 2 * t * t * t) * found) : Eigen::Vector3d::Zero();
}

}  // namespace tetwarp::reference

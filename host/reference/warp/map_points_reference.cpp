/// @file map_points_reference.cpp
/// Back end reference of map_points(): every tetrahedron is tried for every point, in exact
/// integers.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <tetwarp/map_points.hpp>
#include <vector>

#include "host/base/point_backend.hpp"
#include "host/reference/warp/curved_tetrahedron.hpp"
#include "host/reference/warp/exact_geometry.hpp"
#include "host/reference/warp/hexahedron.hpp"

namespace tetwarp {
namespace {
using namespace reference;

Eigen::Vector3d vector_of(const Point3& x) {
  return {x[0], x[1], x[2]};
}

class PointReference {
 public:
  explicit PointReference(const PointPlan& plan)
      : plan_(plan), space_(plan.grid), lone_(plan.mesh.tets.size() - 6 * plan.mesh.hexes.size()) {
    for (const Point3& node : plan.from) rounded_.push_back(space_.quanta_of(node.data()));
    for (std::size_t n = 0; n < plan.to.size() && !plan.mid_nodes.empty(); ++n) {
      rounded_to_.push_back(space_.quanta_if_near(plan.to[n].data()));
    }
    for (std::size_t t = 0; t < plan.mesh.tets.size(); ++t) check_extent(corners_of(t));
  }

  /// Moves a point. @returns the cell that holds it; -1: none, it stays
  /// @param straightened  counts those whose curved map has no inverse
  std::int32_t move(Point3& point, std::int64_t& straightened) const {
    const std::optional<Quanta> x = space_.quanta_if_near(point.data());
    for (std::size_t t = 0; x && t < plan_.mesh.tets.size(); ++t) {
      const Corners corners = corners_of(t);
      if (signed_volume(corners) == 0) continue;
      const std::optional<reference::Barycentric> b = barycentric_of(corners, *x);
      if (!b) continue;
      Eigen::Vector3d motion =
          t < lone_ ? tet_motion(t, b->weight) : hex_motion((t - lone_) / 6, *x);
      if (is_curved(t)) {
        const std::optional<Eigen::Vector3d> curved = curve_motion(t, b->weight, point);
        straightened += !curved;
        motion = curved.value_or(motion);
      }
      for (std::size_t axis = 0; axis < 3; ++axis) {
        point[axis] += motion(static_cast<Eigen::Index>(axis));
      }
      return static_cast<std::int32_t>(t < lone_ ? t : lone_ + (t - lone_) / 6);
    }
    return -1;
  }

 private:
  Corners corners_of(std::size_t t) const {
    Corners corners;
    for (std::size_t node = 0; node < 4; ++node) {
      corners[node] = rounded_[static_cast<std::size_t>(plan_.mesh.tets[t][node])];
    }
    return corners;
  }

  Eigen::Vector3d displacement(std::int32_t node) const {
    const auto n = static_cast<std::size_t>(node);
    return vector_of(plan_.to[n]) - vector_of(plan_.from[n]);
  }

  Eigen::Vector3d tet_motion(std::size_t t, const Eigen::Vector4d& weight) const {
    Eigen::Vector3d motion = Eigen::Vector3d::Zero();
    for (std::size_t node = 0; node < 4; ++node) {
      motion += weight(static_cast<Eigen::Index>(node)) * displacement(plan_.mesh.tets[t][node]);
    }
    return motion;
  }

  std::size_t node_of(std::size_t t, std::size_t n) const {
    return static_cast<std::size_t>(n < 4 ? plan_.mesh.tets[t][n] : plan_.mid_nodes[t][n - 4]);
  }

  bool is_curved(std::size_t t) const {
    if (t >= plan_.mid_nodes.size() || plan_.mid_nodes[t] == no_mid_nodes) return false;
    TenQuanta from, to;
    for (std::size_t n = 0; n < 10; ++n) {
      const std::optional<Quanta>& moved = rounded_to_[node_of(t, n)];
      if (!moved) return true;
      from[n] = rounded_[node_of(t, n)];
      to[n] = *moved;
    }
    return !has_straight_edges(from) || !has_straight_edges(to);
  }

  /// By the shape functions at the place of x in the curved tetrahedron, in voxels around its first
  /// node; 64 are its longest edge along an axis.
  std::optional<Eigen::Vector3d> curve_motion(std::size_t t,
                                              const Eigen::Vector4d& straight,
                                              const Point3& x) const {
    const Eigen::Vector3d origin = vector_of(plan_.from[node_of(t, 0)]);
    QuadraticTetrahedron::Nodes from, motion;
    for (std::size_t n = 0; n < 10; ++n) {
      const auto column = static_cast<Eigen::Index>(n);
      from.col(column) = vector_of(plan_.from[node_of(t, n)]) - origin;
      motion.col(column) = displacement(static_cast<std::int32_t>(node_of(t, n)));
    }
    const double scale = 64 / from.leftCols<4>().cwiseAbs().maxCoeff();
    const auto place = QuadraticTetrahedron(QuadraticTetrahedron::Nodes(scale * from))
                           .inverse(scale * (vector_of(x) - origin), straight);
    if (!place) return std::nullopt;
    return QuadraticTetrahedron(motion).at(*place);
  }

  /// By the trilinear weights of x, whose sum over nodes is taken corner by corner.
  Eigen::Vector3d hex_motion(std::size_t h, const Quanta& x) const {
    reference::HexCorners now;
    for (std::size_t a = 0; a < 8; ++a) {
      now[a] = rounded_[static_cast<std::size_t>(plan_.mesh.hexes[h][a])];
    }
    const Eigen::Vector3d u =
        Trilinear(now).inverse(Eigen::Vector3d(static_cast<double>(x[0]), static_cast<double>(x[1]),
                                               static_cast<double>(x[2])) /
                               one_voxel);
    constexpr int corner[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                  {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    Eigen::Vector3d motion = Eigen::Vector3d::Zero();
    for (std::size_t a = 0; a < 8; ++a) {
      double weight = 1;
      for (int axis = 0; axis < 3; ++axis) {
        weight *= corner[a][axis] != 0 ? u(axis) : 1 - u(axis);
      }
      motion += weight * displacement(plan_.mesh.hexes[h][a]);
    }
    return motion;
  }

  const PointPlan& plan_;
  IndexSpace space_;
  std::vector<Quanta> rounded_;
  /// After the motion, nothing for those too far from the grid; empty: no cell is curved.
  std::vector<std::optional<Quanta>> rounded_to_;
  std::size_t lone_;  // tetrahedra that are not parts of hexahedra; they come first
};
}  // namespace

void move_points_reference(const PointPlan& plan, MappedPoints& result) {
  const PointReference reference(plan);
  for (std::size_t p = 0; p < result.points.size(); ++p) {
    result.owners[p] = reference.move(result.points[p], result.straightened);
  }
}

}  // namespace tetwarp

/// @file map_points_reference.cpp
/// Back end reference of map_points(): every tetrahedron is tried for every point, in exact
/// integers.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <tetwarp/map_points.hpp>
#include <vector>

#include "host/base/point_backend.hpp"
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
    for (std::size_t t = 0; t < plan.mesh.tets.size(); ++t) check_extent(corners_of(t));
  }

  /// Moves a point. @returns the cell that holds it; -1: none, it stays
  std::int32_t move(Point3& point) const {
    const std::optional<Quanta> x = quanta_of(point);
    for (std::size_t t = 0; x && t < plan_.mesh.tets.size(); ++t) {
      const Corners corners = corners_of(t);
      if (signed_volume(corners) == 0) continue;
      const std::optional<reference::Barycentric> b = barycentric_of(corners, *x);
      if (!b) continue;
      const Eigen::Vector3d motion =
          t < lone_ ? tet_motion(t, b->weight) : hex_motion((t - lone_) / 6, *x);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        point[axis] += motion(static_cast<Eigen::Index>(axis));
      }
      return static_cast<std::int32_t>(t < lone_ ? t : lone_ + (t - lone_) / 6);
    }
    return -1;
  }

 private:
  std::optional<Quanta> quanta_of(const Point3& point) const {
    try {
      return space_.quanta_of(point.data());
    } catch (const std::invalid_argument&) {
      return std::nullopt;  // too far from the grid
    }
  }

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
  std::size_t lone_;  // tetrahedra that are not parts of hexahedra; they come first
};
}  // namespace

void move_points_reference(const PointPlan& plan, MappedPoints& result) {
  const PointReference reference(plan);
  for (std::size_t p = 0; p < result.points.size(); ++p) {
    result.owners[p] = reference.move(result.points[p]);
  }
}

}  // namespace tetwarp

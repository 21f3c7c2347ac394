/// @file affine_scenes.hpp
/// Meshes that one linear map moves, whose warps are known everywhere; and the usable back ends.
#pragma once
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/eigen_points.hpp"
#include "tests/support/warp_run.hpp"

namespace tetwarp::test {

/// The usable back ends; tests loop over them.
inline std::vector<Backend> usable_backends() {
  std::vector<Backend> usable;
  for (const BackendStatus& status : available_backends()) {
    if (status.usable) usable.push_back(status.backend);
  }
  return usable;
}

inline Point3 center_of(const Grid& grid) {
  Point3 middle;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    middle[axis] = (static_cast<double>(grid.dims[axis]) - 1) / 2;
  }
  return grid.world_of(middle);
}

/// A mesh over all of the source, moved by `linear` about the source's center.
inline scenes::Scene affine_scene(const Grid& source,
                                  const Grid& output,
                                  const Eigen::Matrix3d& linear) {
  scenes::Scene scene = {"affine", covering_mesh(source), {}, source, output};
  const Eigen::Vector3d center = vector_of(center_of(source));
  for (const Point3& p : scene.mesh.rest_positions) {
    const Eigen::Vector3d x = center + linear * (vector_of(p) - center);
    scene.deformed.push_back({x(0), x(1), x(2)});
  }
  return scene;
}

inline Eigen::Matrix3d turn(double angle, const Eigen::Vector3d& axis) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

}  // namespace tetwarp::test

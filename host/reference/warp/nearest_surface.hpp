/// @file nearest_surface.hpp
/// Displacements outside of a mesh, straight from their definition: every triangle of the surface
/// is tried.
#pragma once
#include <Eigen/Dense>
#include <vector>

#include "host/reference/warp/ownership.hpp"

namespace tetwarp::reference {

/// The surface of a deformed mesh.
class NearestSurface {
 public:
  /// @param rest, deformed  positions of the mesh's nodes [world]
  NearestSurface(const WarpPlan& plan,
                 const Ownership& owners,
                 const double* rest,
                 const double* deformed);

  /// Displacement at a voxel of the output grid: that of the nearest point, with Outside::falloff
  /// weighted by its distance [world].
  Eigen::Vector3d displacement(const Eigen::Vector3d& index) const;

 private:
  struct Triangle {
    Eigen::Matrix3d at;       ///< columns: deformed corners, from the output's origin [world]
    Eigen::Matrix3d to_rest;  ///< columns: rest minus deformed corners
  };

  std::vector<Triangle> triangles_;
  Eigen::Matrix3d to_world_;
  bool falls_;
  double reach_;
};

}  // namespace tetwarp::reference

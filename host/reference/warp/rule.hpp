/// @file rule.hpp
/// Back end reference: what a voxel gets beyond a plain sample, from the definitions.
#pragma once
#include <Eigen/Dense>

#include <tetwarp/warp.hpp>

#include "host/reference/warp/exact_geometry.hpp"

namespace tetwarp::reference {

/// What one tetrahedron does to the samples that it brings.
struct Rule {
  Eigen::Vector3i parts = {1, 1, 1};                      ///< samples along each axis of a voxel
  Eigen::Matrix3d step = Eigen::Matrix3d::Identity();     ///< source index by output index
  Eigen::Matrix3d forward = Eigen::Matrix3d::Identity();  ///< deformation gradient in the world
  bool is_singular = false;                               ///< flat at rest: there is no gradient
  bool is_still = true;                                   ///< moves nothing but by whole voxels
  double scale = 1;                                       ///< of a density

  bool averages() const { return parts.maxCoeff() > 1; }
};

/// Samples along each axis that a step from voxel to voxel asks for.
Eigen::Vector3i parts_of(const Eigen::Matrix3d& step);

/// The rule of a tetrahedron that is not flat.
Rule rule_of(const Corners& rest,
             const Corners& now,
             const IndexSpace& source,
             const IndexSpace& output,
             const WarpOptions& options);

/// Components as a deformation gradient takes them along.
Eigen::VectorXd reoriented(const Eigen::VectorXd& values,
                           Quantity quantity,
                           const Eigen::Matrix3d& forward);

}  // namespace tetwarp::reference

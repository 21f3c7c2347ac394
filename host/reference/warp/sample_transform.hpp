/// @file sample_transform.hpp
/// Averages, reorientation and density in the reference, from the definitions.
#pragma once
#include <Eigen/Dense>

#include <tetwarp/warp.hpp>

#include "host/reference/warp/exact_geometry.hpp"

namespace tetwarp::reference {

/// The change of samples in one tetrahedron.
struct SampleTransform {
  Eigen::Vector3i parts = {1, 1, 1};                      ///< samples along each axis of a voxel
  Eigen::Matrix3d step = Eigen::Matrix3d::Identity();     ///< source index by output index
  Eigen::Matrix3d forward = Eigen::Matrix3d::Identity();  ///< deformation gradient in the world
  bool is_singular = false;                               ///< flat at rest: there is no gradient
  bool is_still = true;                                   ///< a shift by whole voxels
  double scale = 1;                                       ///< factor of densities

  bool averages() const { return parts.maxCoeff() > 1; }
};

/// Samples to average along each axis.
/// @param step  source index by output index
Eigen::Vector3i parts_of(const Eigen::Matrix3d& step);

/// The transform of a tetrahedron that is not flat.
SampleTransform transform_of(const Corners& rest,
                             const Corners& now,
                             const IndexSpace& source,
                             const IndexSpace& output,
                             const WarpOptions& options);

/// Components of a quantity after a deformation.
/// @param forward  deformation gradient in world axes
Eigen::VectorXd reoriented(const Eigen::VectorXd& values,
                           Quantity quantity,
                           const Eigen::Matrix3d& forward);

}  // namespace tetwarp::reference

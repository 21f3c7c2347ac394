/// @file polar_rotation.hpp
/// The rotation of a polar decomposition.
#pragma once
#include <Eigen/Core>

namespace tetwarp::reference {

/// The proper rotation R that maximizes tr(R^T F), by the singular value decomposition.
Eigen::Matrix3d polar_rotation(const Eigen::Matrix3d& deformation);

}  // namespace tetwarp::reference

/// @file polar_rotation.cpp
/// The factors of the decomposition, with the sign of the least singular value that makes R proper.
#include "host/reference/linear/polar_rotation.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>

namespace tetwarp::reference {

Eigen::Matrix3d polar_rotation(const Eigen::Matrix3d& deformation) {
  const Eigen::JacobiSVD<Eigen::Matrix3d, Eigen::NoQRPreconditioner> svd(
      deformation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * Eigen::Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
}

}  // namespace tetwarp::reference

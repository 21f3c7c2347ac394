/// @file sample_transform.cpp
/// Parts of source voxels, rotations of gradients, and transformed samples.
#include "host/reference/warp/sample_transform.hpp"

#include <algorithm>
#include <cmath>

#include "host/reference/linear/polar_rotation.hpp"

namespace tetwarp::reference {
namespace {
/// Edges from the first node as columns [voxel].
Eigen::Matrix3d edges_of(const Corners& tet) {
  Eigen::Matrix3d edges;
  for (std::size_t node = 1; node < 4; ++node) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      edges(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(node) - 1) =
          static_cast<double>(tet[node][axis] - tet[0][axis]) / one_voxel;
    }
  }
  return edges;
}

Eigen::Matrix3d tensor_of(const Eigen::VectorXd& d) {
  Eigen::Matrix3d tensor;
  tensor << d(0), d(3), d(5), d(3), d(1), d(4), d(5), d(4), d(2);
  return tensor;
}

Eigen::VectorXd components_of(const Eigen::Matrix3d& tensor) {
  Eigen::VectorXd d(6);
  d << tensor(0, 0), tensor(1, 1), tensor(2, 2), tensor(0, 1), tensor(1, 2), tensor(0, 2);
  return d;
}

/// The rotation that takes e1 to n1 = F e1 and e2 to the part of n2 = F e2 orthogonal to n1, all
/// normalized. Source: Alexander et al. 2001.
Eigen::Matrix3d principal_rotation(const Eigen::Matrix3d& tensor, const Eigen::Matrix3d& forward) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(tensor);
  const Eigen::Vector3d e1 = eigen.eigenvectors().col(2), e2 = eigen.eigenvectors().col(1);
  const Eigen::Vector3d n1 = (forward * e1).normalized();
  const Eigen::Vector3d n2 = (forward * e2).normalized();
  const Eigen::Vector3d across = (n2 - n1.dot(n2) * n1).normalized();
  Eigen::Matrix3d before, after;
  before << e1, e2, e1.cross(e2);
  after << n1, across, n1.cross(across);
  return after * before.transpose();
}
}  // namespace

Eigen::Vector3i parts_of(const Eigen::Matrix3d& step) {
  Eigen::Vector3i parts;
  for (int axis = 0; axis < 3; ++axis) {
    const double length = step.col(axis).norm();
    const double whole = std::ceil(length - 1 / one_voxel);
    parts(axis) = length > 1.5 + 1 / one_voxel ? static_cast<int>(std::min(whole, 16.0)) : 1;
  }
  return parts;
}

SampleTransform transform_of(const Corners& rest,
                             const Corners& now,
                             const IndexSpace& source,
                             const IndexSpace& output,
                             const WarpOptions& options) {
  SampleTransform transform;
  if (source.to_world == output.to_world && whole_shift(rest, now)) return transform;
  const Eigen::Matrix3d rest_edges = edges_of(rest), edges = edges_of(now);
  transform.is_still = false;
  transform.step = rest_edges * edges.inverse();
  if (options.antialias) transform.parts = parts_of(transform.step);
  transform.is_singular = signed_volume(rest) == 0;
  if (!transform.is_singular) {
    transform.forward = output.to_world * edges * (source.to_world * rest_edges).inverse();
  }
  if (options.intensity != Intensity::value) {
    const double ratio = source.to_world.determinant() / output.to_world.determinant();
    transform.scale = std::abs(static_cast<double>(signed_volume(rest)) /
                               static_cast<double>(signed_volume(now)) * ratio);
  }
  return transform;
}

Eigen::VectorXd reoriented(const Eigen::VectorXd& values,
                           Quantity quantity,
                           const Eigen::Matrix3d& forward) {
  switch (quantity) {
    case Quantity::components:
      break;
    case Quantity::vector:
      return polar_rotation(forward) * values;
    case Quantity::covariant_vector:
      return forward.inverse().transpose() * values;
    case Quantity::contravariant_vector:
      return forward * values;
    case Quantity::tensor: {
      const Eigen::Matrix3d rotation = polar_rotation(forward);
      return components_of(rotation * tensor_of(values) * rotation.transpose());
    }
    case Quantity::principal_tensor: {
      const Eigen::Matrix3d rotation = principal_rotation(tensor_of(values), forward);
      return components_of(rotation * tensor_of(values) * rotation.transpose());
    }
  }
  return values;
}

}  // namespace tetwarp::reference

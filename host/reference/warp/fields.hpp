/// @file fields.hpp
/// Fields of the deformation in the reference: straight from node positions.
#pragma once
#include <Eigen/Dense>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/reference/warp/exact_geometry.hpp"

namespace tetwarp::reference {

/// F = d deformed / d rest of a tetrahedron that is not flat at rest, in world axes.
inline Eigen::Matrix3d gradient_of(const Corners& rest,
                                   const IndexSpace& source,
                                   const Corners& deformed,
                                   const IndexSpace& output) {
  const auto edges = [](const Corners& tet, const IndexSpace& space) {
    Eigen::Matrix3d columns;
    for (std::size_t node = 1; node < 4; ++node) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        columns(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(node - 1)) =
            static_cast<double>(tet[node][axis] - tet[0][axis]) / one_voxel;
      }
    }
    return Eigen::Matrix3d(space.to_world * columns);
  };
  return edges(deformed, output) * edges(rest, source).inverse();
}

/// Green-Lagrange strain, (F^T F - I) / 2.
inline Eigen::Matrix3d green_lagrange(const Eigen::Matrix3d& gradient) {
  return (gradient.transpose() * gradient - Eigen::Matrix3d::Identity()) / 2;
}

/// Stores `values` as the components of voxel v; does nothing for a null array.
template <std::size_t count>
void store(const double (&values)[count], std::size_t v, float* array) {
  if (array == nullptr) return;
  std::transform(values, values + count, array + count * v,
                 [](double value) { return static_cast<float>(value); });
}

}  // namespace tetwarp::reference

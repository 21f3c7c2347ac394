/// @file index_space.hpp
/// Maps between the world and the index spaces of grids.
#pragma once
#include <array>
#include <cmath>
#include <cstddef>

#include <tetwarp/volume.hpp>

#include "kernels/base/index_space.hpp"

namespace tetwarp {

/// The map from world to index positions: inverse of direction * diag(spacing), and the origin. The
/// inverse of a diagonal matrix consists of the rounded reciprocals. @pre check_grid() has passed
TETWARP_EXPORT IndexFromWorld index_from_world(const Grid& grid);

/// Length of one step along a grid axis [world].
inline double step_length(const Grid& grid, std::size_t axis) {
  const auto& d = grid.direction;
  return grid.spacing[axis] * std::hypot(d[axis], d[3 + axis], d[6 + axis]);
}

/// Index positions of the same world position in two grids: x_source = linear * x_output + offset.
struct IndexMap {
  std::array<double, 9> linear;
  std::array<double, 3> offset;
};

/// A map within 2^-40 of a whole-voxel shift is rounded to it, so that samples are copied between
/// grids that differ by whole voxels.
IndexMap source_from_output(const Grid& source, const Grid& output);

}  // namespace tetwarp

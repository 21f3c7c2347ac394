/// @file index_space.hpp
/// World to index space of a grid: the one place where the matrix is inverted.
#pragma once
#include <array>

#include <tetwarp/volume.hpp>

#include "kernels/base/index_space.hpp"

namespace tetwarp {

/// Inverse of direction * diag(spacing) and the origin. By pivoted elimination, so that a diagonal
/// matrix has exactly the reciprocals. @pre the grid passed check_grid().
IndexFromWorld index_from_world(const Grid& grid);

/// The map output index -> source index of one world position: x_source = linear * x_output +
/// offset.
struct IndexMap {
  std::array<double, 9> linear;
  std::array<double, 3> offset;
};

/// Entries within 2^-40 of a whole-voxel shift are rounded to it, so that congruent grids copy.
IndexMap source_from_output(const Grid& source, const Grid& output);

}  // namespace tetwarp

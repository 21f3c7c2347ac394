/// @file region_grid.hpp
/// The part of a grid that a region selects.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>

#include <tetwarp/volume.hpp>

namespace tetwarp {

/// The region, or all of the grid without one.
/// @throws std::invalid_argument when it is empty or not within the grid
inline Region checked_region(const Grid& grid, const std::optional<Region>& region) {
  if (!region) return {{0, 0, 0}, grid.dims};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t begin = region->begin[axis], end = region->end[axis];
    if (begin < 0 || begin >= end || end > grid.dims[axis]) {
      throw std::invalid_argument(
          "region: " + std::to_string(begin) + " to " + std::to_string(end) + " on axis " +
          std::to_string(axis) + " is empty or not within 0 to " + std::to_string(grid.dims[axis]));
    }
  }
  return *region;
}

/// The grid of a region's voxels.
inline Grid grid_of_region(const Grid& grid, const Region& region) {
  Grid part = grid;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    part.dims[axis] = region.end[axis] - region.begin[axis];
  }
  if (region.begin != std::array<std::int64_t, 3>{0, 0, 0}) {
    part.origin =
        grid.world_of({static_cast<double>(region.begin[0]), static_cast<double>(region.begin[1]),
                       static_cast<double>(region.begin[2])});
  }
  return part;
}

}  // namespace tetwarp

/// @file clear_blocks.hpp
/// ClearBlocks: where a volume is certainly transparent.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include <tetwarp/cast.hpp>

namespace tetwarp {

/// A volume in blocks of 8 x 8 x 8 voxels.
struct ClearBlocks {
  static constexpr int edge = 8;

  std::array<std::int64_t, 3> dims{};  ///< blocks
  std::vector<std::uint8_t> is_clear;  ///< of each block, whether all its points are transparent

  /// Whether the block of a position in index space is clear.
  bool has(const Point3& index) const {
    std::int64_t block = 0;
    for (std::size_t axis = 3; axis-- > 0;) {
      const auto place = static_cast<std::int64_t>(index[axis] > 0 ? index[axis] : 0) / edge;
      block = block * dims[axis] + (place < dims[axis] ? place : dims[axis] - 1);
    }
    return is_clear[static_cast<std::size_t>(block)] != 0;
  }
};

ClearBlocks clear_blocks(const Volume& volume, const TransferFunction& colors);

}  // namespace tetwarp

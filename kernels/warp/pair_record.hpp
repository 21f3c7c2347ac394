/// @file pair_record.hpp
/// Stage "raster" of the warp on a device: all that the voxels of a cell need of one tetrahedron,
/// relative to the cell in float32.
#pragma once
#include <cstdint>

#include "kernels/warp/row_span.hpp"

namespace tetwarp {

/// The map of a tetrahedron. A device loads it by accesses of 16 bytes; its size keeps those to
/// neighboring maps in shared memory apart.
struct alignas(16) PairMap {
  float base[3];       ///< as in SourceMap
  float axis[3][3];    ///< as in SourceMap
  const void* source;  ///< the sample at the map's first voxel, which may lie outside the source
  std::int32_t tet;
  float whole[3];  ///< the map's first voxel, relative to the source's window
};
static_assert(sizeof(PairMap) == 80);

/// What the rows of a cell need of a tetrahedron before its bounds: bits 0 to 7 the rows j within
/// its box, 8 to 15 the layers k, then the numbers of bounds from below and above, two bits each.
using PairHead = std::uint32_t;
constexpr int layer_bits = 8, below_bits = 16, above_bits = 18;
constexpr PairHead accepted_cell = 0x80000000u;  ///< the cell lies within the tetrahedron

/// Bit b for each voxel corner + b, b in 0..7, that lies in [begin, end).
TETWARP_HD unsigned bits_within(int begin, int end, int corner) {
  const int first = min_of(max_of(begin - corner, 0), cell_edge);
  const int past = min_of(max_of(end - corner, 0), cell_edge);
  return ((1u << past) - 1) & ~((1u << first) - 1);
}

/// The head of a pair without its bounds.
TETWARP_HD PairHead pair_head(const TetSetup& tet, const int* corner) {
  return bits_within(tet.begin[1], tet.end[1], corner[1]) |
         bits_within(tet.begin[2], tet.end[2], corner[2]) << layer_bits;
}

}  // namespace tetwarp

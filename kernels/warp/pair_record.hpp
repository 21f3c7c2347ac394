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

/// The rows of a cell within the box of a tetrahedron: a rectangle along j and k.
struct PairRows {
  int first_j, first_k;
  int width;      ///< rows along j, 1 to 8
  int layers;     ///< along k
  int per_width;  ///< a number of row below 64, times this, divided by 256: its layer

  TETWARP_HD int count() const { return width * layers; }
  TETWARP_HD bool holds(int j, int k) const {
    return j >= first_j && j < first_j + width && k >= first_k && k < first_k + layers;
  }
};

/// What the rows of a cell need of a tetrahedron before its bounds: a PairRows, three bits a
/// number, nine of per_width, and the numbers of bounds from below and above, two bits each.
using PairHead = std::uint32_t;
constexpr int width_bits = 3, first_k_bits = 6, layer_bits = 9, per_width_bits = 12;
constexpr int below_bits = 21, above_bits = 23;
constexpr PairHead accepted_cell = 0x80000000u;  ///< the cell lies within the tetrahedron

/// Bit b for each voxel corner + b, b in 0..7, that lies in [begin, end).
TETWARP_HD unsigned bits_within(int begin, int end, int corner) {
  const int first = min_of(max_of(begin - corner, 0), cell_edge);
  const int past = min_of(max_of(end - corner, 0), cell_edge);
  return ((1u << past) - 1) & ~((1u << first) - 1);
}

/// The head of a pair without its bounds. @pre its box touches the cell
TETWARP_HD PairHead pair_head(const TetSetup& tet, const int* corner) {
  unsigned first[2], more[2];  // rows after the first
  for (int a = 0; a < 2; ++a) {
    const int low = max_of(tet.begin[a + 1] - corner[a + 1], 0);
    first[a] = static_cast<unsigned>(low) & 7u;
    more[a] =
        static_cast<unsigned>(min_of(tet.end[a + 1] - corner[a + 1], cell_edge) - 1 - low) & 7u;
  }
  const unsigned per_width = (256 + more[0]) / (more[0] + 1);
  return first[0] | more[0] << width_bits | first[1] << first_k_bits | more[1] << layer_bits |
         per_width << per_width_bits;
}

TETWARP_HD PairRows row_box(PairHead head) {
  const auto field = [&](int bits, unsigned mask) { return static_cast<int>(head >> bits & mask); };
  return {field(0, 7), field(first_k_bits, 7), field(width_bits, 7) + 1, field(layer_bits, 7) + 1,
          field(per_width_bits, 511)};
}

}  // namespace tetwarp

/// @file pair_record.hpp
/// Stage "raster" of the warp on a device: all that the voxels of a cell need of one tetrahedron,
/// relative to the cell in float32. Only for cells whose samples all lie in the source.
#pragma once
#include <cstdint>

#include "kernels/warp/cell_planes.hpp"
#include "kernels/warp/tet_setup.hpp"

namespace tetwarp {

/// The map of a tetrahedron, and the voxels of the cell within its box.
struct PairMap {
  float base[3];       ///< as in SourceMap
  float axis[3][3];    ///< as in SourceMap
  const void* source;  ///< the sample at the map's first voxel
  std::int32_t tet;
  std::uint32_t voxels;  ///< from box_bits()
};

/// A tetrahedron that may own voxels of a cell. A device loads it by eight accesses of 16 bytes.
struct alignas(16) PairRecord {
  CellPlanes planes;
  PairMap map;
};
static_assert(sizeof(PairRecord) == 128);

constexpr std::uint32_t accepted_voxels = 0x80000000u;  ///< in box_bits(): all voxels are inside

/// Bit b for each voxel corner + b, b in 0..7, that lies in [begin, end).
TETWARP_HD unsigned bits_within(int begin, int end, int corner) {
  const int first = min_of(max_of(begin - corner, 0), cell_edge);
  const int past = min_of(max_of(end - corner, 0), cell_edge);
  return ((1u << past) - 1) & ~((1u << first) - 1);
}

/// The place of row j in box_bits().
TETWARP_HD int row_bit(int j) {
  return j / 2 * 8 + 2 + j % 2;
}

/// The part of a cell within the box of a tetrahedron: bit 8 d + b for layer k = 2 d + b, bit
/// row_bit(j) for row j; accepted_voxels where the cell lies within the tetrahedron.
TETWARP_HD std::uint32_t box_bits(const TetSetup& tet, const int* corner, bool is_accepted) {
  const auto spread = [](unsigned bits) {  // two of eight bits to each byte
    const unsigned halves = (bits | bits << 12) & 0x000f000fu;
    return (halves | halves << 6) & 0x03030303u;
  };
  const unsigned rows = bits_within(tet.begin[1], tet.end[1], corner[1]);
  const unsigned layers = bits_within(tet.begin[2], tet.end[2], corner[2]);
  return spread(rows) << 2 | spread(layers) | (is_accepted ? accepted_voxels : 0u);
}

}  // namespace tetwarp

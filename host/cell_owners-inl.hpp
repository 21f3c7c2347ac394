/// @file cell_owners-inl.hpp
/// Who owns the voxels of a cell. Included once per vector instruction set (the
/// name and the toggled guard are Highway's convention).
#if defined(TETWARP_CELL_OWNERS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_CELL_OWNERS_INL
#undef TETWARP_CELL_OWNERS_INL
#else
#define TETWARP_CELL_OWNERS_INL
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cstdint>

#include "host/cell_sides-inl.hpp"
#include "kernels/cell_raster.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// The part of a cell that is in the output, and where the cell is.
struct CellBox {
  int corner[3];  ///< frame voxel
  int begin[3];   ///< voxels of the cell, 0 to 8
  int end[3];
};

inline CellBox make_cell_box(const OutputFrame& frame, int ci, int cj, int ck) {
  const int cell[3] = {ci, cj, ck};
  CellBox box;
  for (int axis = 0; axis < 3; ++axis) {
    box.corner[axis] = cell[axis] * cell_edge;
    box.begin[axis] = std::max(frame.begin[axis] - box.corner[axis], 0);
    box.end[axis] = std::min(frame.end[axis] - box.corner[axis], cell_edge);
  }
  return box;
}

/// Bits of rows [begin, end) with the bits `row` in each.
inline SliceBits rows_between(int begin, int end, unsigned row) {
  if (begin >= end) return 0;
  const SliceBits all = ~SliceBits{0} >> (64 - 8 * (end - begin)) << (8 * begin);
  return all & (0x0101010101010101u * SliceBits{row});
}

/// Gives every voxel of a cell to its lowest tetrahedron.
/// @param job     planes, nodes and pairs
/// @param box     the cell
/// @param range   its pairs
/// @param open    in and out, per slice: voxels without an owner
/// @param counts  tests are added
/// @param own     own(pair, k, bits) is told of every slice in which a pair owns voxels, pairs
///                ascending
template <class T, class Own>
inline void find_owners(const RasterJob<T>& job,
                        const CellBox& box,
                        const CellRange& range,
                        SliceBits* open,
                        RasterCounts& counts,
                        Own&& own) {
  for (std::uint32_t p = range.begin; p < range.end; ++p) {
    if (is_accepted(job.pairs[p])) {
      for (int k = box.begin[2]; k < box.end[2]; ++k) {
        if (open[k] != 0) own(p, k, open[k]);
        open[k] = 0;
      }
      return;
    }
    const int t = tet_of(job.pairs[p]);
    const TetSetup& tet = job.setups[t];
    int begin[3], end[3];
    for (int axis = 0; axis < 3; ++axis) {
      begin[axis] = std::max(tet.begin[axis] - box.corner[axis], box.begin[axis]);
      end[axis] = std::min(tet.end[axis] - box.corner[axis], box.end[axis]);
    }
    const SliceBits rows = rows_between(begin[1], end[1], 0xff);
    SliceBits asked = 0;
    for (int k = begin[2]; k < end[2]; ++k) asked |= open[k] & rows;
    if (asked == 0) continue;
    CellPlanes planes;
    for (int face = 0; face < 4; ++face) {
      set_cell_plane(tet, face, box.corner[0], box.corner[1], box.corner[2], planes);
    }
    SliceSides sides[cell_edge];
    cell_sides(planes, begin[2], end[2], sides);
    SliceBits left = 0;
    for (int k = begin[2]; k < end[2]; ++k) {
      const SliceBits tested = open[k] & rows;
      counts.inside_tests += std::popcount(tested);
      SliceBits mine = sides[k].inside & tested;
      for (SliceBits unsure = sides[k].unsure & tested; unsure != 0; unsure &= unsure - 1) {
        const int bit = std::countr_zero(unsure);
        const int side = certain_side(planes, bit % 8, bit / 8, k);
        if (side > 0) mine |= SliceBits{1} << bit;
        if (side != 0) continue;
        ++counts.exact_tests;
        const TetNodes nodes = tet_nodes(job.nodes, job.tets.data + std::int64_t{4} * t);
        if (is_inside_exact(nodes, box.corner[0] + bit % 8, box.corner[1] + bit / 8,
                            box.corner[2] + k)) {
          mine |= SliceBits{1} << bit;
        }
      }
      if (mine != 0) own(p, k, mine);
      open[k] &= ~mine;
    }
    for (int k = box.begin[2]; k < box.end[2]; ++k) left |= open[k];
    if (left == 0) return;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard

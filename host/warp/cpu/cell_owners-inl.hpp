/// @file cell_owners-inl.hpp
/// The owners of the voxels of a cell. Included once per vector instruction set.
#if defined(TETWARP_CELL_OWNERS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_CELL_OWNERS_INL
#undef TETWARP_CELL_OWNERS_INL
#else
#define TETWARP_CELL_OWNERS_INL
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cstdint>

#include "host/warp/cpu/cell_sides-inl.hpp"
#include "kernels/warp/cell_raster.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// A cell: its position and the part of it that is in the output.
struct CellBox {
  int corner[3];  ///< first voxel [frame voxel]
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

/// Adds to `mine` those of the voxels `unsure` that lie inside tetrahedron t.
inline void test_each(const RasterGeometry& job,
                      const CellBox& box,
                      int t,
                      const CellPlanes& planes,
                      const CellBits& unsure,
                      CellBits& mine,
                      RasterCounts& counts) {
  for (int k = 0; k < cell_edge; ++k) {
    for (SliceBits bits = unsure.slice[k]; bits != 0; bits &= bits - 1) {
      const int bit = std::countr_zero(bits);
      int side = certain_side(planes, bit % 8, bit / 8, k);
      if (side == 0) {
        ++counts.exact_tests;
        const TetNodes nodes = tet_nodes(job.nodes, job.tets.data + std::int64_t{4} * t);
        side = is_inside_exact(nodes, box.corner[0] + bit % 8, box.corner[1] + bit / 8,
                               box.corner[2] + k);
      }
      if (side > 0) mine.slice[k] |= SliceBits{1} << bit;
    }
  }
}

/// Prefetches the setup of the tetrahedron of pair `p`.
inline void fetch_ahead(const RasterGeometry& job, std::uint32_t p) {
  if (p >= static_cast<std::uint64_t>(job.pairs.size)) return;
  const TetSetup* setup = &job.setups[tet_of(job.pairs[p])];
  for (std::size_t byte = 0; byte < sizeof(TetSetup); byte += 64) {
    hwy::Prefetch(reinterpret_cast<const char*>(setup) + byte);
  }
}

/// Sets `mine` to those of the voxels `open` of a cell that lie inside tetrahedron t.
/// @returns whether there are any; if not, `mine` is undefined
inline bool find_inside(const RasterGeometry& job,
                        const CellBox& box,
                        int t,
                        const CellBits& open,
                        CellBits& mine,
                        RasterCounts& counts) {
  const TetSetup& tet = job.setups[t];
  int begin[3], end[3];
  for (int axis = 0; axis < 3; ++axis) {
    begin[axis] = std::max(tet.begin[axis] - box.corner[axis], box.begin[axis]);
    end[axis] = std::min(tet.end[axis] - box.corner[axis], box.end[axis]);
  }
  const SliceTag d;
  const hn::RebindToSigned<SliceTag> di;
  const auto rows = hn::Set(d, rows_between(begin[1], end[1], 0xff));
  const auto below = hn::Set(di, begin[2] - 1), above = hn::Set(di, end[2]);
  CellBits tested;
  auto some = hn::Zero(d);
  for_slices([&](std::size_t k) {
    const auto slice = hn::Iota(di, static_cast<std::int64_t>(k));
    const auto is_in = hn::And(hn::Gt(slice, below), hn::Gt(above, slice));
    const auto bits = hn::And(hn::Load(d, open.slice + k), rows);
    const auto kept = hn::IfThenElseZero(hn::RebindMask(d, is_in), bits);
    hn::Store(kept, d, tested.slice + k);
    some = hn::Or(some, kept);
  });
  if (hn::AllTrue(d, hn::Eq(some, hn::Zero(d)))) return false;
  counts.inside_tests += count_of(tested);
  CellPlanes planes;
  set_cell_planes(tet, box.corner, planes);
  CellBits inside = {}, possible = {};
  cell_sides(planes, {begin[1], end[1], begin[2], end[2]}, inside, possible);
  CellBits unsure;
  auto some_mine = hn::Zero(d), some_unsure = hn::Zero(d);
  for_slices([&](std::size_t k) {
    const auto bits = hn::Load(d, tested.slice + k), sure = hn::Load(d, inside.slice + k);
    const auto is_mine = hn::And(sure, bits);
    const auto is_unsure = hn::AndNot(sure, hn::And(hn::Load(d, possible.slice + k), bits));
    hn::Store(is_mine, d, mine.slice + k);
    hn::Store(is_unsure, d, unsure.slice + k);
    some_mine = hn::Or(some_mine, is_mine);
    some_unsure = hn::Or(some_unsure, is_unsure);
  });
  if (!hn::AllTrue(d, hn::Eq(some_unsure, hn::Zero(d)))) {
    test_each(job, box, t, planes, unsure, mine, counts);
    return any_of(mine);
  }
  return !hn::AllTrue(d, hn::Eq(some_mine, hn::Zero(d)));
}

/// Assigns every voxel of a cell to the tetrahedron of the lowest number that contains it.
/// @param job     planes, nodes and pairs
/// @param box     the cell
/// @param range   its pairs
/// @param open    in and out: voxels without an owner
/// @param counts  numbers of tests are added
/// @param own     own(pair, bits) is called for every pair that owns voxels, pairs ascending
template <class Own>
inline void find_owners(const RasterGeometry& job,
                        const CellBox& box,
                        const CellRange& range,
                        CellBits& open,
                        RasterCounts& counts,
                        Own&& own) {
  for (std::uint32_t p = range.begin; p < range.end; ++p) {
    fetch_ahead(job, p + 3);
    if (is_accepted(job.pairs[p])) {
      own(p, open);
      open = {};
      return;
    }
    CellBits mine;
    if (!find_inside(job, box, tet_of(job.pairs[p]), open, mine, counts)) continue;
    own(p, mine);
    const SliceTag d;
    auto some = hn::Zero(d);
    for_slices([&](std::size_t k) {
      const auto left = hn::AndNot(hn::Load(d, mine.slice + k), hn::Load(d, open.slice + k));
      hn::Store(left, d, open.slice + k);
      some = hn::Or(some, left);
    });
    if (hn::AllTrue(d, hn::Eq(some, hn::Zero(d)))) return;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard

/// @file cell_sides-inl.hpp
/// The voxels of a cell that lie inside a tetrahedron, as an interval per row. Included once per
/// vector instruction set.
#if defined(TETWARP_CELL_SIDES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_CELL_SIDES_INL
#undef TETWARP_CELL_SIDES_INL
#else
#define TETWARP_CELL_SIDES_INL
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "kernels/warp/cell_raster.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Bit 8 j + i of a slice is voxel (i, j).
using SliceBits = std::uint64_t;

/// A bit per voxel of a cell.
struct CellBits {
  alignas(64) SliceBits slice[cell_edge];
};

inline bool any_of(const CellBits& bits) {
  SliceBits all = 0;
  for (const SliceBits slice : bits.slice) all |= slice;
  return all != 0;
}

inline int count_of(const CellBits& bits) {
  int count = 0;
  for (const SliceBits slice : bits.slice) count += std::popcount(slice);
  return count;
}

using SliceTag = hn::CappedTag<SliceBits, cell_edge>;  ///< one lane per slice

/// Calls op(lane) for the first slice of each vector of slices.
template <class Op>
HWY_INLINE void for_slices(const Op& op) {
  for (std::size_t lane = 0; lane < cell_edge; lane += hn::Lanes(SliceTag())) op(lane);
}

/// Bit 8 k + j: row (j, k) has a voxel.
inline std::uint64_t rows_of(const CellBits& bits) {
  const hn::CappedTag<std::uint8_t, sizeof(CellBits)> d;
  const auto* rows = reinterpret_cast<const std::uint8_t*>(bits.slice);
  std::uint64_t mask = 0;
  for (std::size_t row = 0; row < sizeof(CellBits); row += hn::Lanes(d)) {
    const auto some = hn::Ne(hn::Load(d, rows + row), hn::Zero(d));
    std::uint8_t part[8] = {};
    hn::StoreMaskBits(d, some, part);
    std::uint64_t word;
    std::memcpy(&word, part, sizeof(word));
    mask |= word << row;
  }
  return mask;
}

/// cell_plane() of the four faces, with equal bits.
inline void set_cell_planes(const TetSetup& tet, const int* corner, CellPlanes& planes) {
  const hn::CappedTag<double, 4> d;  // one lane per face
  const hn::Rebind<float, decltype(d)> df;
  hn::Vec<decltype(d)> from[3];
  for (int axis = 0; axis < 3; ++axis) {
    from[axis] = hn::Set(d, static_cast<double>(corner[axis] - tet.anchor[axis]));
  }
  for (std::size_t face = 0; face < 4; face += hn::Lanes(d)) {
    const auto normal = [&](int axis) { return hn::LoadU(d, tet.plane[axis] + face); };
    auto value = hn::Mul(normal(0), from[0]);
    value = hn::Add(value, hn::Mul(normal(1), from[1]));
    value = hn::Add(value, hn::Mul(normal(2), from[2]));
    value = hn::Add(value, hn::LoadU(d, tet.plane[3] + face));
    const auto unit = hn::Mul(hn::Add(hn::Abs(value), hn::Set(d, 24.0)), hn::Set(d, 0x1p-21));
    const auto scale = hn::Div(hn::Set(d, 1.0), unit);
    hn::StoreU(hn::DemoteTo(df, hn::Mul(value, scale)), df, planes.value + face);
    for (int axis = 0; axis < 3; ++axis) {
      hn::StoreU(hn::DemoteTo(df, hn::Mul(normal(axis), scale)), df, planes.step[axis] + face);
    }
  }
}

/// The positions along x where rows cross the planes of a tetrahedron.
///
/// certain_side() returns 0 only where a plane value is within 1.7 of zero, in the unit of
/// CellPlanes, and rounding moves a crossing by less than 1.8 / |step|. Farther than `width` from a
/// crossing, which is at least `margin` / |step|, interval and certain_side() therefore agree.
struct RowCrossings {
  static constexpr float margin = 4.0f;
  static constexpr float min_step = 0x1p-3f;  ///< below, the value changes by less than 1 in a row

  explicit RowCrossings(const CellPlanes& planes) {
    const hn::FixedTag<float, 4> d;  // one lane per face
    const auto zero = hn::Zero(d), never = hn::Set(d, std::numeric_limits<float>::infinity());
    const auto step = hn::LoadU(d, planes.step[0]);
    const auto is_flat = hn::Lt(hn::Abs(step), hn::Set(d, min_step));
    const auto voxels = hn::IfThenZeroElse(is_flat, hn::Div(hn::Set(d, -1.0f), step));
    hn::Store(hn::Mul(hn::LoadU(d, planes.value), voxels), d, at);
    hn::Store(hn::Mul(hn::LoadU(d, planes.step[1]), voxels), d, per_row);
    hn::Store(hn::Mul(hn::LoadU(d, planes.step[2]), voxels), d, per_slice);
    hn::Store(hn::IfThenZeroElse(hn::Lt(voxels, zero), hn::Neg(never)), d, if_entering);
    hn::Store(hn::IfThenZeroElse(hn::Gt(voxels, zero), never), d, if_leaving);
    width = margin * hn::GetLane(hn::MaxOfLanes(d, hn::Abs(voxels)));
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, is_flat, bits);
    flat = bits[0];
  }

  alignas(16) float at[4];  ///< crossing of row 0 of slice 0 [voxel]
  alignas(16) float per_row[4];
  alignas(16) float per_slice[4];
  alignas(16) float if_entering[4];  ///< 0 where rows enter through the face, else -infinity
  alignas(16) float if_leaving[4];   ///< 0 where rows leave through the face, else +infinity
  float width;                       ///< [voxel]
  unsigned flat;                     ///< bits of the faces with steps below min_step
};

/// Rows of a cell that intersect the bounding box of a tetrahedron.
struct RowBox {
  int j_begin, j_end, k_begin, k_end;
};

using SideTag = hn::CappedTag<float, 2 * cell_edge>;  ///< one lane per row
using SideIntTag = hn::RebindToSigned<SideTag>;
using SideByteTag = hn::Rebind<std::uint8_t, SideTag>;

/// The first voxel of a row at or beyond a position, 0 to 8.
HWY_INLINE hn::Vec<SideTag> voxel_from(hn::Vec<SideTag> x) {
  const SideTag d;
  return hn::Ceil(hn::Min(hn::Max(x, hn::Zero(d)), hn::Set(d, float{cell_edge})));
}

/// Bits [begin, past) of each row.
HWY_INLINE hn::Vec<SideByteTag> row_bits(hn::Vec<SideTag> begin, hn::Vec<SideTag> past) {
  const SideTag d;
  const SideIntTag di;
  const auto all = hn::Set(di, -1);
  // Above 2^23 the low bits of a float32 are those of the number.
  const auto shift_by = [&](hn::Vec<SideTag> x) {
    return hn::And(hn::BitCast(di, hn::Add(x, hn::Set(d, 0x1p23f))), hn::Set(di, 15));
  };
  const auto bits = hn::AndNot(hn::Shl(all, shift_by(past)), hn::Shl(all, shift_by(begin)));
  return hn::TruncateTo(SideByteTag(), hn::BitCast(hn::RebindToUnsigned<SideIntTag>(), bits));
}

/// Stores the rows of a vector, `slice_rows` per slice, from row (j, k) on.
template <int slice_rows>
HWY_INLINE void store_rows(hn::Vec<SideByteTag> rows, int j, int k, CellBits& bits) {
  constexpr int lanes = static_cast<int>(hn::MaxLanes(SideTag()));
  if constexpr (slice_rows == cell_edge || lanes <= slice_rows) {
    hn::StoreU(rows, SideByteTag(), reinterpret_cast<std::uint8_t*>(&bits.slice[k]) + j);
    return;
  }
  std::uint8_t part[lanes];
  hn::StoreU(rows, SideByteTag(), part);
  for (int slice = 0; slice < std::max(lanes / slice_rows, 1); ++slice) {
    auto* row = reinterpret_cast<std::uint8_t*>(&bits.slice[k + slice]) + j;
    std::memcpy(row, part + slice_rows * slice, std::min(lanes, slice_rows));
  }
}

/// Empties the intervals of rows that are parallel to a face and outside of it.
/// @param past       in and out: end of the certain interval
/// @param past_late  in and out: end of the possible one
HWY_INLINE void cut_flat_faces(const CellPlanes& planes,
                               unsigned flat,
                               hn::Vec<SideTag> j,
                               hn::Vec<SideTag> k,
                               hn::Vec<SideTag>& past,
                               hn::Vec<SideTag>& past_late) {
  const SideTag d;
  for (; flat != 0; flat &= flat - 1) {
    const int face = std::countr_zero(flat);
    const auto value = hn::Add(
        hn::Add(hn::Set(d, planes.value[face]), hn::Mul(j, hn::Set(d, planes.step[1][face]))),
        hn::Mul(k, hn::Set(d, planes.step[2][face])));
    const auto margin = hn::Set(d, RowCrossings::margin);
    past = hn::IfThenElseZero(hn::Gt(value, margin), past);
    past_late = hn::IfThenElseZero(hn::Gt(value, hn::Neg(margin)), past_late);
  }
}

/// cell_sides() for `slice_rows` rows of each slice, from `j_first` on. A vector holds one row per
/// lane; wider vectors hold the rows of several slices.
template <int slice_rows>
inline void packed_sides(const CellPlanes& planes,
                         const RowBox& box,
                         int j_first,
                         CellBits& inside,
                         CellBits& possible) {
  const SideTag d;
  const SideIntTag di;
  constexpr int lanes = static_cast<int>(hn::MaxLanes(d));
  constexpr int slices = std::max(lanes / slice_rows, 1);
  constexpr int slice_bits = slice_rows == 8 ? 3 : 2;
  const RowCrossings rows(planes);
  const auto width = hn::Set(d, rows.width);
  const auto lane = hn::Iota(di, 0);
  const auto lane_k = hn::ConvertTo(d, hn::ShiftRight<slice_bits>(lane));
  const auto lane_j = hn::ConvertTo(d, hn::And(lane, hn::Set(di, slice_rows - 1)));
  for (int j_part = 0; j_part < slice_rows; j_part += lanes) {
    const auto j = hn::Add(lane_j, hn::Set(d, static_cast<float>(j_first + j_part)));
    const int steps = (box.k_end - box.k_begin + slices - 1) / slices;
    const int k_first = std::min(box.k_begin, cell_edge - slices * steps);
    hn::Vec<decltype(d)> entering[4], leaving[4], step[4];
    for (int face = 0; face < 4; ++face) {
      const float slice = rows.at[face] + rows.per_slice[face] * static_cast<float>(k_first);
      auto at = hn::Add(hn::Set(d, slice), hn::Mul(j, hn::Set(d, rows.per_row[face])));
      at = hn::Add(at, hn::Mul(lane_k, hn::Set(d, rows.per_slice[face])));
      entering[face] = hn::Add(at, hn::Set(d, rows.if_entering[face]));
      leaving[face] = hn::Add(at, hn::Set(d, rows.if_leaving[face]));
      step[face] = hn::Set(d, slices * rows.per_slice[face]);
    }
    for (int k = k_first; k < box.k_end; k += slices) {
      const auto enter =
          hn::Max(hn::Max(entering[0], entering[1]), hn::Max(entering[2], entering[3]));
      const auto leave = hn::Min(hn::Min(leaving[0], leaving[1]), hn::Min(leaving[2], leaving[3]));
      for (int face = 0; face < 4; ++face) {
        entering[face] = hn::Add(entering[face], step[face]);
        leaving[face] = hn::Add(leaving[face], step[face]);
      }
      const auto begin = voxel_from(hn::Add(enter, width));
      const auto begin_early = voxel_from(hn::Sub(enter, width));
      auto past = voxel_from(hn::Sub(leave, width));
      auto past_late = voxel_from(hn::Add(leave, width));
      const auto slice = hn::Add(lane_k, hn::Set(d, static_cast<float>(k)));
      cut_flat_faces(planes, rows.flat, j, slice, past, past_late);
      const auto sure = row_bits(begin, past);
      store_rows<slice_rows>(sure, j_first + j_part, k, inside);
      const auto is_sure = hn::And(hn::Eq(begin, begin_early), hn::Eq(past, past_late));
      const bool all_sure = hn::AllTrue(d, is_sure);
      store_rows<slice_rows>(all_sure ? sure : row_bits(begin_early, past_late), j_first + j_part,
                             k, possible);
    }
  }
}

/// Finds the voxels of the rows `box` of a cell that are certainly inside a tetrahedron.
/// @param inside    out: certainly inside; undefined in other rows
/// @param possible  out: inside or too close to a face for float32, to be decided by certain_side()
inline void cell_sides(const CellPlanes& planes,
                       const RowBox& box,
                       CellBits& inside,
                       CellBits& possible) {
  const int j_first = std::min(box.j_begin, cell_edge / 2);
  if (box.j_end <= j_first + cell_edge / 2) {
    packed_sides<cell_edge / 2>(planes, box, j_first, inside, possible);
  } else {
    packed_sides<cell_edge>(planes, box, 0, inside, possible);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard

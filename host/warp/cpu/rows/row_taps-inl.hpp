/// @file row_taps-inl.hpp
/// The samples that the voxels of a row read: offsets and weights, eight voxels per unit. Included
/// once per vector instruction set.
///
/// A row is computed in two passes, so that the arithmetic does not wait for memory: this one fills
/// a buffer of taps, row_vector-inl.hpp reads the source and blends.
#if defined(TETWARP_ROW_TAPS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_ROW_TAPS_INL
#undef TETWARP_ROW_TAPS_INL
#else
#define TETWARP_ROW_TAPS_INL
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <cstdint>

#include "host/warp/cpu/rows/row_source-inl.hpp"
#include "kernels/warp/cell_raster.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using RowTag = hn::CappedTag<float, cell_edge>;  ///< voxels of a row, eight at most
using RowIntTag = hn::RebindToSigned<RowTag>;

/// Eight voxels of a row: one row of one cell.
struct RowUnit {
  std::uint16_t cell;   ///< number in the line
  std::uint8_t bits;    ///< voxels to write
  std::uint8_t inside;  ///< of these, inside the source
};

/// Taps of up to `row_units` units.
/// @tparam is_rim  neighbors may be clamped, so that every voxel needs the offsets of its four
///                 lines; otherwise these are at fixed distances from the first
template <bool is_rim>
struct RowTaps {
  static constexpr int row_units = 16;

  int count = 0;
  RowUnit unit[row_units];
  /// Offset of the lower neighbor along x on line (y, z), with is_rim also on (y+1, z), (y, z+1)
  /// and (y+1, z+1) [voxel].
  alignas(64) std::int32_t offset[is_rim ? 4 : 1][cell_edge * row_units];
  alignas(64) float fraction[3][cell_edge * row_units];
};

/// Mask of the vector that starts at voxel `lane` of a unit.
inline hn::Mask<RowTag> lanes_of(unsigned bits, std::size_t lane) {
  const std::uint8_t part[8] = {static_cast<std::uint8_t>(bits >> lane)};
  return hn::LoadMaskBits(RowTag(), part);
}

inline unsigned bits_of(hn::Mask<RowTag> mask, std::size_t lane) {
  std::uint8_t part[8] = {};
  hn::StoreMaskBits(RowTag(), mask, part);
  return unsigned{part[0]} << lane;
}

/// Positions of a vector of voxels, as local and whole parts like in SourceMap.
template <bool is_rim>
struct RowPositions {
  hn::Vec<RowTag> local[3];
  hn::Vec<RowIntTag> whole[is_rim ? 3 : 1];  ///< per axis; without is_rim RowSource::tap_origin()
};

/// Local positions at the start of row (j, k), the first sums of local_position().
struct RowStart {
  RowStart(const RowSource& source, int j, int k) {
    const hn::FixedTag<float, 4> d;
    const auto row = hn::Mul(hn::Load(d, source.axis[1]), hn::Set(d, static_cast<float>(j)));
    const auto slice = hn::Mul(hn::Load(d, source.axis[2]), hn::Set(d, static_cast<float>(k)));
    hn::Store(hn::Add(hn::Add(hn::Load(d, source.base), row), slice), d, at);
  }
  alignas(16) float at[4];
};

/// local_position() of the voxels of a row from `lane` on.
template <bool is_rim>
inline RowPositions<is_rim> row_positions(const RowSource& source,
                                          const RowStart& start,
                                          std::size_t lane) {
  const RowTag d;
  const auto i = hn::Iota(d, static_cast<float>(lane));
  RowPositions<is_rim> positions;
  for (int axis = 0; axis < 3; ++axis) {
    positions.local[axis] =
        hn::Add(hn::Set(d, start.at[axis]), hn::Mul(hn::Set(d, source.axis[0][axis]), i));
    if constexpr (is_rim) positions.whole[axis] = hn::Set(RowIntTag(), source.whole[axis]);
  }
  if constexpr (!is_rim) {
    positions.whole[0] = hn::Set(RowIntTag(), source.tap_origin());
  }
  return positions;
}

/// Positions of the voxels of row (j, k) of a cell from `lane` on, each by the map of its own run.
/// Voxels of no run use the map of the first: their taps are readable, their values not used.
/// @param bits  the voxels of all runs but the first are added
template <bool is_rim>
HWY_INLINE RowPositions<is_rim> unit_positions(const RowSource* sources,
                                               const RowRun* runs,
                                               int run_count,
                                               const RowStart& first_start,
                                               int j,
                                               int k,
                                               std::size_t lane,
                                               unsigned& bits) {
  RowPositions<is_rim> x = row_positions<is_rim>(sources[runs[0].source], first_start, lane);
  for (int r = 1; r < run_count; ++r) {
    const RowSource& source = sources[runs[r].source];
    const RowPositions<is_rim> more = row_positions<is_rim>(source, RowStart(source, j, k), lane);
    bits |= runs[r].bits;
    const auto mine = lanes_of(runs[r].bits, lane);
    const auto mine_int = hn::RebindMask(RowIntTag(), mine);
    for (int axis = 0; axis < 3; ++axis) {
      x.local[axis] = hn::IfThenElse(mine, more.local[axis], x.local[axis]);
    }
    for (int part = 0; part < (is_rim ? 3 : 1); ++part) {
      x.whole[part] = hn::IfThenElse(mine_int, more.whole[part], x.whole[part]);
    }
  }
  return x;
}

/// Neighbors of a vector of voxels along one axis.
struct AxisTaps {
  hn::Vec<RowIntTag> voxel;    ///< lower neighbor; without is_rim bits of its number without the
                               ///< whole part, plus whole_shift
  hn::Vec<RowTag> fraction;    ///< from it to the upper one
  hn::Vec<RowIntTag> step;     ///< to the upper one in memory [voxel]; is_rim only
  hn::Mask<RowTag> in_source;  ///< is_rim only
};

/// @param near    local positions, for nearest plus one half
/// @param stride  from a voxel to the next along the axis in memory [voxel]
template <bool is_rim>
HWY_INLINE AxisTaps
axis_taps(const RowPositions<is_rim>& x, hn::Vec<RowTag> near, int axis, int dim, int stride) {
  const RowTag d;
  const RowIntTag di;
  AxisTaps taps;
  const auto floor = hn::Floor(near);
  taps.fraction = hn::Sub(near, floor);
  if constexpr (!is_rim) {
    taps.voxel = hn::BitCast(di, hn::Add(floor, hn::Set(d, whole_shift)));
  } else {
    taps.voxel = hn::Add(hn::ConvertTo(di, floor), x.whole[axis]);
    const int last = dim - 1;
    const auto whole = hn::ConvertTo(d, x.whole[axis]);
    const auto low = hn::Sub(hn::Sub(hn::Set(d, -0.5f), whole), hn::Set(d, rim_slack));
    const auto beyond = hn::ConvertTo(d, hn::Sub(hn::Set(di, last), x.whole[axis]));
    const auto high = hn::Add(hn::Add(beyond, hn::Set(d, 0.5f)), hn::Set(d, rim_slack));
    taps.in_source = hn::And(hn::Ge(x.local[axis], low), hn::Le(x.local[axis], high));
    const auto blends =
        hn::And(hn::Gt(taps.voxel, hn::Set(di, -1)), hn::Lt(taps.voxel, hn::Set(di, last)));
    taps.fraction = hn::IfThenElseZero(hn::RebindMask(d, blends), taps.fraction);
    taps.voxel = hn::Min(hn::Max(taps.voxel, hn::Zero(di)), hn::Set(di, last));
    taps.step = hn::IfThenElseZero(blends, hn::Set(di, stride));
  }
  return taps;
}

/// Stores offsets and fractions of some voxels at place `to` of `taps`.
/// @returns which of them lie inside the source; without is_rim all
template <bool is_rim>
HWY_INLINE hn::Mask<RowTag> store_taps(const SourceShape& source,
                                       bool nearest,
                                       const RowPositions<is_rim>& x,
                                       std::size_t to,
                                       RowTaps<is_rim>& taps) {
  const RowTag d;
  const RowIntTag di;
  const int stride[3] = {1, source.dims[0], source.dims[0] * source.dims[1]};
  AxisTaps along[3];
  auto in_source = hn::Eq(hn::Zero(d), hn::Zero(d));
  for (int axis = 0; axis < 3; ++axis) {
    const auto near = nearest ? hn::Add(x.local[axis], hn::Set(d, 0.5f)) : x.local[axis];
    along[axis] = axis_taps<is_rim>(x, near, axis, source.dims[axis], stride[axis]);
    if constexpr (is_rim) in_source = hn::And(in_source, along[axis].in_source);
    hn::Store(along[axis].fraction, d, taps.fraction[axis] + to);
  }
  auto offset = along[0].voxel;
  if constexpr (!is_rim) offset = hn::Add(offset, x.whole[0]);
  offset = hn::Add(offset, hn::Mul(along[1].voxel, hn::Set(di, stride[1])));
  offset = hn::Add(offset, hn::Mul(along[2].voxel, hn::Set(di, stride[2])));
  hn::Store(offset, di, taps.offset[0] + to);
  if constexpr (is_rim) {
    const auto above = hn::Add(offset, along[2].step);
    hn::Store(hn::Add(offset, along[1].step), di, taps.offset[1] + to);
    hn::Store(above, di, taps.offset[2] + to);
    hn::Store(hn::Add(above, along[1].step), di, taps.offset[3] + to);
  }
  return in_source;
}

/// Adds one unit: row (j, k) of one cell, given by `runs`. @pre no run is of RowKind::alone
template <bool is_rim>
inline void add_unit(const SourceShape& source,
                     bool nearest,
                     const RowSource* sources,
                     const RowRun* runs,
                     int run_count,
                     int j,
                     int k,
                     RowTaps<is_rim>& taps) {
  const auto at = static_cast<std::size_t>(cell_edge * taps.count);
  unsigned bits = runs[0].bits, inside = is_rim ? 0 : 0xff;
  const RowSource& first = sources[runs[0].source];
  const RowStart first_start(first, j, k);
  for (std::size_t lane = 0; lane < cell_edge; lane += hn::Lanes(RowTag())) {
    const auto x = unit_positions<is_rim>(sources, runs, run_count, first_start, j, k, lane, bits);
    const auto in_source = store_taps(source, nearest, x, at + lane, taps);
    if constexpr (is_rim) inside |= bits_of(in_source, lane);
  }
  // The processor does not prefetch across the distance to the next rows.
  for (const std::size_t voxel : {0, cell_edge / 2}) {
    fetch_next_rows(first, source.data + source.voxel_bytes * taps.offset[0][at + voxel]);
  }
  taps.unit[taps.count++] = {runs[0].cell, static_cast<std::uint8_t>(bits),
                             static_cast<std::uint8_t>(bits & inside)};
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard

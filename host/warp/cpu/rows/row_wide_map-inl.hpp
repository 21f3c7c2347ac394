/// @file row_wide_map-inl.hpp
/// The map of one tetrahedron over one row of a cell in float64. Included once per vector
/// instruction set.
#if defined(TETWARP_ROW_WIDE_MAP_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_ROW_WIDE_MAP_INL
#undef TETWARP_ROW_WIDE_MAP_INL
#else
#define TETWARP_ROW_WIDE_MAP_INL
#endif

#include <hwy/highway.h>

#include <cstddef>

#include "host/warp/cpu/rows/row_source-inl.hpp"
#include "kernels/warp/cell_raster.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Source positions along row (j, k) of a cell, bit-equal to SourceMap<double> and
/// local_position(): voxel i is at whole + (line + step i). One entry per axis of the source; the
/// fourth is padding whose bounds accept every position.
struct WideMap {
  using Tag = hn::CappedTag<double, 4>;

  WideMap(const SourceShape& shape, const RowSource& source, int j, int k) {
    const Tag d;
    const TetSetup& tet = source.setup();
    const int* corner = source.corner();
    for (int axis = 0; axis < 3; ++axis) last[axis] = shape.dims[axis] - 1;
    for (std::size_t lane = 0; lane < 4; lane += hn::Lanes(d)) {
      auto start = hn::Zero(d);
      for (int a = 0; a < 3; ++a) {
        const auto from = hn::Set(d, static_cast<double>(corner[a] - tet.anchor[a]));
        const auto part = hn::Mul(hn::LoadU(d, tet.map[a] + lane), from);
        start = a == 0 ? part : hn::Add(start, part);
      }
      start = hn::Add(start, hn::LoadU(d, tet.map[3] + lane));
      const auto limit = hn::Set(d, max_whole), slack = hn::Set(d, double{rim_slack});
      const auto floor = hn::Floor(hn::Min(hn::Max(start, hn::Neg(limit)), limit));
      const auto of_row = hn::Mul(hn::LoadU(d, tet.map[1] + lane), hn::Set(d, double(j)));
      const auto of_slice = hn::Mul(hn::LoadU(d, tet.map[2] + lane), hn::Set(d, double(k)));
      const auto half = hn::Set(d, 0.5);
      const auto local = hn::Sub(floor, hn::LoadU(d, shape.origin + lane));
      const auto end = hn::Add(hn::Sub(hn::Load(d, last + lane), local), half);
      hn::Store(hn::Add(hn::Add(hn::Sub(start, floor), of_row), of_slice), d, line + lane);
      hn::Store(hn::LoadU(d, tet.map[0] + lane), d, step + lane);
      hn::Store(local, d, whole + lane);
      hn::Store(hn::Sub(hn::Sub(hn::Neg(half), local), slack), d, low + lane);
      hn::Store(hn::Add(end, slack), d, high + lane);
    }
  }

  alignas(32) double line[4];
  alignas(32) double step[4];
  alignas(32) double whole[4];
  alignas(32) double low[4];                  ///< least local position inside the source
  alignas(32) double high[4];                 ///< largest one
  alignas(32) double last[4] = {0, 0, 0, 0};  ///< voxel of the source
};

/// Neighbors of samples along an axis of the source, bit-equal to tap_of(). One sample or one axis
/// per lane.
template <class Tag>
struct WideAxisTaps {
  using Numbers = hn::Vec<Tag>;

  /// @param x      positions local to `whole`; low, high and last as in WideMap
  HWY_INLINE WideAxisTaps(
      Numbers x, Numbers whole, Numbers low, Numbers high, Numbers last, bool nearest) {
    const Tag d;
    const auto near = nearest ? hn::Add(x, hn::Set(d, 0.5)) : x;
    const auto lower = hn::Floor(near), zero = hn::Zero(d);
    const auto at = hn::Add(whole, lower);
    is_inside = hn::And(hn::Ge(x, low), hn::Le(x, high));
    blends = hn::And(hn::Ge(at, zero), hn::Lt(at, last));
    fraction = hn::IfThenElseZero(blends, hn::Sub(near, lower));
    voxel = hn::Min(hn::Max(at, zero), last);
  }

  hn::Mask<Tag> is_inside;
  hn::Mask<Tag> blends;  ///< the upper neighbor is another voxel than the lower one
  Numbers fraction;      ///< from the lower neighbor to the upper one
  Numbers voxel;         ///< lower neighbor
};

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard

/// @file row_wide_taps-inl.hpp
/// Positions of samples in float64: offsets and weights of their neighbors. Included once per
/// vector instruction set.
#if defined(TETWARP_ROW_WIDE_TAPS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_ROW_WIDE_TAPS_INL
#undef TETWARP_ROW_WIDE_TAPS_INL
#else
#define TETWARP_ROW_WIDE_TAPS_INL
#endif

#include <hwy/highway.h>

#include <array>
#include <cstddef>
#include <cstdint>

#include "host/warp/cpu/rows/row_source-inl.hpp"
#include "host/warp/cpu/rows/row_wide_map-inl.hpp"
#include "kernels/warp/tet_transform.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using WideTag = hn::CappedTag<double, cell_edge>;  ///< samples, eight at most

/// Samples to read. Vectors are stored from `count` on; entries beyond `count` have no meaning.
struct WideTaps {
  static constexpr int capacity = 256;
  static constexpr int padded = capacity + 2 * cell_edge;

  int count = 0;
  /// Offset of the lower neighbor [voxel]; in the source for every sample.
  alignas(64) std::int32_t offset[padded];
  alignas(64) std::int32_t is_inside[padded];  ///< 1 where the source is defined, else 0
  /// From the lower neighbor to the upper one; 0: the upper one is not used and may not exist.
  alignas(64) double fraction[3][padded];
};

/// Positions of a vector of samples, local to WideMap::whole.
struct WidePositions {
  hn::Vec<WideTag> at[3];
};

/// Stores the neighbors and weights of a vector of samples at place `to`, bit-equal to tap_of().
HWY_INLINE void store_wide_taps(const SourceShape& shape,
                                const WideMap& map,
                                bool nearest,
                                const WidePositions& x,
                                std::size_t to,
                                WideTaps& taps) {
  const WideTag d;
  const hn::Rebind<std::int32_t, WideTag> di;
  auto inside = hn::Eq(hn::Zero(d), hn::Zero(d));
  hn::Vec<WideTag> voxel[3];
  for (int axis = 0; axis < 3; ++axis) {
    const WideAxisTaps<WideTag> along(x.at[axis], hn::Set(d, map.whole[axis]),
                                      hn::Set(d, map.low[axis]), hn::Set(d, map.high[axis]),
                                      hn::Set(d, map.last[axis]), nearest);
    inside = hn::And(inside, along.is_inside);
    hn::StoreU(nearest ? hn::Zero(d) : along.fraction, d, taps.fraction[axis] + to);
    voxel[axis] = along.voxel;
  }
  const auto row = hn::Add(hn::Mul(voxel[2], hn::Set(d, double(shape.dims[1]))), voxel[1]);
  const auto offset = hn::Add(hn::Mul(row, hn::Set(d, double(shape.dims[0]))), voxel[0]);
  hn::StoreU(hn::DemoteTo(di, offset), di, taps.offset + to);
  hn::StoreU(hn::DemoteTo(di, hn::IfThenElseZero(inside, hn::Set(d, 1.0))), di,
             taps.is_inside + to);
}

/// Adds the centers of voxels [begin, end) of a row.
inline void add_centers(const SourceShape& shape,
                        const WideMap& map,
                        bool nearest,
                        int begin,
                        int end,
                        WideTaps& taps) {
  const WideTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int i = begin; i < end; i += lanes) {
    const auto along = hn::Iota(d, double(i));
    WidePositions x;
    for (int axis = 0; axis < 3; ++axis) {
      const auto step = hn::Mul(hn::Set(d, map.step[axis]), along);
      x.at[axis] = hn::Add(hn::Set(d, map.line[axis]), step);
    }
    store_wide_taps(shape, map, nearest, x, static_cast<std::size_t>(taps.count + i - begin), taps);
  }
  taps.count += end - begin;
}

/// Middle of part n of p equal parts of a voxel, from the voxel's center, at [p - 1][n] [voxel].
using PartMiddles = std::array<std::array<double, max_parts>, max_parts>;
constexpr PartMiddles make_part_middles() {
  PartMiddles middles = {};
  for (std::size_t parts = 1; parts <= max_parts; ++parts) {
    for (std::size_t n = 0; n < parts; ++n) {
      middles[parts - 1][n] = (static_cast<double>(n) + 0.5) / static_cast<double>(parts) - 0.5;
    }
  }
  return middles;
}
inline constexpr PartMiddles part_middles = make_part_middles();

/// Source offsets of successive parts of a voxel from the voxel's center.
struct PartOffsets {
  static constexpr int capacity = 64;

  /// Computes those of parts [begin, begin + count), as store_transformed() does.
  PartOffsets(const TetSetup& tet, const int* parts, int begin, int part_count)
      : count(part_count) {
    const WideMap::Tag d;
    int n[3] = {begin % parts[0], begin / parts[0] % parts[1], begin / parts[0] / parts[1]};
    for (int p = 0; p < count; ++p) {
      for (std::size_t lane = 0; lane < 4; lane += hn::Lanes(d)) {
        const auto along = [&](int a) {
          const auto middle = hn::Set(
              d,
              part_middles[static_cast<std::size_t>(parts[a] - 1)][static_cast<std::size_t>(n[a])]);
          return hn::Mul(hn::LoadU(d, tet.map[a] + lane), middle);
        };
        hn::Store(hn::Add(hn::Add(along(0), along(1)), along(2)), d, at + 4 * p + lane);
      }
      for (int axis = 0; axis < 3 && ++n[axis] == parts[axis] && axis < 2; ++axis) n[axis] = 0;
    }
  }

  int count;
  alignas(64) double at[4 * (capacity + cell_edge)];  ///< [part][axis], the fourth unused
};

/// Adds parts of voxel i of a row.
inline void add_parts(const SourceShape& shape,
                      const WideMap& map,
                      bool nearest,
                      int i,
                      const PartOffsets& parts,
                      WideTaps& taps) {
  const WideTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  hn::Vec<WideTag> center[3];
  for (int axis = 0; axis < 3; ++axis) {
    center[axis] = hn::Set(d, map.line[axis] + map.step[axis] * double(i));
  }
  for (int p = 0; p < parts.count; p += lanes) {
    WidePositions x;
    hn::Vec<WideTag> unused;
    hn::LoadInterleaved4(d, parts.at + 4 * p, x.at[0], x.at[1], x.at[2], unused);
    for (int axis = 0; axis < 3; ++axis) x.at[axis] = hn::Add(center[axis], x.at[axis]);
    store_wide_taps(shape, map, nearest, x, static_cast<std::size_t>(taps.count + p), taps);
  }
  taps.count += parts.count;
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard

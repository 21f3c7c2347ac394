/// @file row_wide-inl.hpp
/// Samples of a row voxel by voxel, for rows that vectors of voxels cannot compute: 32-bit and
/// wider integers, float64 and steep maps, in float64 with one lane per axis of the source.
/// Included once per vector instruction set.
#if defined(TETWARP_ROW_WIDE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_ROW_WIDE_INL
#undef TETWARP_ROW_WIDE_INL
#else
#define TETWARP_ROW_WIDE_INL
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "host/warp/cpu/rows/row_scalar.hpp"
#include "host/warp/cpu/rows/row_source-inl.hpp"
#include "host/warp/cpu/rows/row_vector-inl.hpp"
#include "host/warp/cpu/rows/row_wide_map-inl.hpp"
#include "kernels/warp/cell_raster.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Positions and neighbors of the voxels of row (j, k) of a cell, bit-equal to tap_of().
class WideRow {
 public:
  WideRow(const SourceShape& shape, const RowSource& source, bool nearest, int j, int k)
      : map_(shape, source, j, k), nearest_(nearest) {}

  /// Finds the neighbors of voxel i. @returns whether it lies inside the source
  bool move_to(int i) {
    bool inside = true;
    for (std::size_t lane = 0; lane < 4; lane += hn::Lanes(d)) {
      const auto along = hn::Mul(hn::Load(d, map_.step + lane), hn::Set(d, double(i)));
      const auto x = hn::Add(hn::Load(d, map_.line + lane), along);
      const WideAxisTaps<WideMap::Tag> taps(
          x, hn::Load(d, map_.whole + lane), hn::Load(d, map_.low + lane),
          hn::Load(d, map_.high + lane), hn::Load(d, map_.last + lane), nearest_);
      inside = inside && hn::AllTrue(d, taps.is_inside);
      hn::Store(taps.fraction, d, fraction + lane);
      hn::Store(hn::DemoteTo(di, taps.voxel), di, voxel + lane);
      hn::Store(hn::DemoteTo(di, hn::IfThenElseZero(taps.blends, hn::Set(d, 1.0))), di,
                upper + lane);
    }
    return inside;
  }

  alignas(32) double fraction[4];
  alignas(16) std::int32_t voxel[4];  ///< lower neighbor
  alignas(16) std::int32_t upper[4];  ///< distance to the upper neighbor: 1, at the boundary 0

 private:
  static constexpr WideMap::Tag d{};
  static constexpr hn::Rebind<std::int32_t, WideMap::Tag> di{};

  WideMap map_;
  bool nearest_;
};

/// Writes the voxels `bits` of row (j, k) in float64.
template <class T>
inline void sample_wide(const RasterJob<T>& job,
                        const SourceShape& shape,
                        const RowSource& source,
                        unsigned bits,
                        int j,
                        int k,
                        std::int64_t row) {
  const hn::FixedTag<double, 2> d;  // both neighbors along x
  const SourceView<T>& view = job.source;
  const std::ptrdiff_t components = view.components;
  const std::ptrdiff_t up = components * view.dims[0], far = up * view.dims[1];
  const bool nearest = job.filter == Filter::nearest;
  WideRow taps(shape, source, nearest, j, k);
  for (int n = 0; bits != 0; bits &= bits - 1, ++n) {
    const int i = std::countr_zero(bits);
    T* out = job.volume + (row + i) * components;
    if (!taps.move_to(i)) {
      std::fill_n(out, components, job.background);
      continue;
    }
    const T* samples =
        view.data + taps.voxel[0] * components + taps.voxel[1] * up + taps.voxel[2] * far;
    if (n % (cell_edge / 2) == 0) fetch_next_rows(source, samples);
    if (nearest) {
      std::copy_n(samples, components, out);
      continue;
    }
    const std::ptrdiff_t x = taps.upper[0] * components, y = taps.upper[1] * up,
                         z = taps.upper[2] * far;
    const auto fy = hn::Set(d, taps.fraction[1]), fz = hn::Set(d, taps.fraction[2]);
    for (std::ptrdiff_t c = 0; c < components; ++c, ++samples) {
      const auto pair = [&](std::ptrdiff_t line) {
        const double both[2] = {static_cast<double>(samples[line]),
                                static_cast<double>(samples[line + x])};
        return hn::LoadU(d, both);
      };
      const auto near = lerp_lanes(fy, pair(0), pair(y)),
                 next = lerp_lanes(fy, pair(z), pair(z + y));
      double column[2];
      hn::StoreU(lerp_lanes(fz, near, next), d, column);
      out[c] = rounded_to<T>(lerp_of(taps.fraction[0], column[0], column[1]));
    }
  }
}

/// Writes the voxels `bits` of a row of RowKind::alone.
template <class T>
inline void sample_alone(const RasterJob<T>& job,
                         const SourceShape& shape,
                         const RowSource& source,
                         unsigned bits,
                         int j,
                         int k,
                         std::int64_t row) {
  const MapKind kind = source.setup().kind;
  if (kind == MapKind::trilinear || (sizeof(ArithmeticOf<T>) == 4 && kind == MapKind::affine)) {
    write_scalar_run(pixel_type_of<T>(), job, source.map(), bits, j, k, row);
  } else {
    sample_wide(job, shape, source, bits, j, k, row);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard

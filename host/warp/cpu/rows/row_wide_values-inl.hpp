/// @file row_wide_values-inl.hpp
/// Sums of samples by linear interpolation in float64, bit-equal to linear_value(). Included once
/// per vector instruction set.
#if defined(TETWARP_ROW_WIDE_VALUES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_ROW_WIDE_VALUES_INL
#undef TETWARP_ROW_WIDE_VALUES_INL
#else
#define TETWARP_ROW_WIDE_VALUES_INL
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "host/warp/cpu/rows/row_vector-inl.hpp"
#include "host/warp/cpu/rows/row_wide_taps-inl.hpp"
#include "kernels/warp/cell_raster.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int block_size = 4;  ///< components are stored in blocks of four

/// Values of voxels.
struct WideValues {
  static constexpr int voxels = 64;
  static constexpr int padding = 2 * cell_edge;  ///< entries that vectors may cover beyond the last
  static constexpr int blocks = 3;               ///< of up to nine components

  int count = 0;
  int samples[voxels];  ///< number of samples added
  /// Sums of samples, [component / 4][voxel][component % 4]; of one component [voxel].
  alignas(64) double sum[blocks][(voxels + padding) * block_size];
};

/// Successive samples of one voxel.
struct WideRun {
  std::int32_t voxel;  ///< of WideValues
  std::int32_t first;  ///< sample of WideTaps
  std::int32_t count;
};

/// Distances in memory to the upper neighbors along x, y, z [sample].
struct UpperSteps {
  std::ptrdiff_t x, y, z;
};

/// Steps of sample s that never lead out of the source.
inline UpperSteps steps_within(const UpperSteps& steps, const WideTaps& taps, int s) {
  return {taps.fraction[0][s] > 0 ? steps.x : 0, taps.fraction[1][s] > 0 ? steps.y : 0,
          taps.fraction[2][s] > 0 ? steps.z : 0};
}

using BlockTag = hn::CappedTag<double, block_size>;  ///< components of one voxel

/// Components of a voxel from `samples` on as float64. A vector may extend beyond the voxel.
template <class T>
HWY_INLINE hn::Vec<BlockTag> read_block(const T* samples) {
  const BlockTag d;
  if constexpr (std::is_same_v<T, double>) {
    return hn::LoadU(d, samples);
  } else if constexpr (sizeof(T) == 4 && !std::is_same_v<T, std::uint32_t>) {
    return hn::PromoteTo(d, hn::LoadU(hn::Rebind<T, BlockTag>(), samples));
  } else if constexpr (sizeof(T) <= 2) {
    const hn::Rebind<std::int32_t, BlockTag> di;
    return hn::PromoteTo(d, hn::PromoteTo(di, hn::LoadU(hn::Rebind<T, BlockTag>(), samples)));
  } else {
    alignas(32) double converted[block_size];
    for (std::size_t c = 0; c < hn::Lanes(d); ++c) converted[c] = static_cast<double>(samples[c]);
    return hn::Load(d, converted);
  }
}

/// The same of `count` components at the end of the source.
template <class T>
inline hn::Vec<BlockTag> read_last_block(const T* samples, std::ptrdiff_t count) {
  alignas(32) double converted[block_size] = {};
  for (std::ptrdiff_t c = 0; c < std::min<std::ptrdiff_t>(count, block_size); ++c) {
    converted[c] = static_cast<double>(samples[c]);
  }
  return hn::Load(BlockTag(), converted);
}

/// Adds samples of several components.
/// @tparam is_end  a vector could pass the end of the source
template <bool is_end, class T>
inline void add_components(const SourceView<T>& view,
                           const WideTaps& taps,
                           const WideRun* runs,
                           int run_count,
                           WideValues& values) {
  const BlockTag d;
  const std::ptrdiff_t components = view.components;
  const UpperSteps all = {components, components * view.dims[0],
                          components * view.dims[0] * view.dims[1]};
  for (const WideRun* run = runs; run < runs + run_count; ++run) {
    for (int s = run->first; s < run->first + run->count; ++s) {
      if (taps.is_inside[s] == 0) continue;
      ++values.samples[run->voxel];
      const UpperSteps step = is_end ? steps_within(all, taps, s) : all;
      const T* samples = view.data + components * taps.offset[s];
      const auto fx = hn::Set(d, taps.fraction[0][s]), fy = hn::Set(d, taps.fraction[1][s]),
                 fz = hn::Set(d, taps.fraction[2][s]);
      for (std::ptrdiff_t c = 0; c < components; c += static_cast<std::ptrdiff_t>(hn::Lanes(d))) {
        const auto read = [&](std::ptrdiff_t at) {
          if constexpr (is_end) return read_last_block(samples + c + at, components - c);
          return read_block(samples + c + at);
        };
        const auto column = [&](std::ptrdiff_t x) {
          return lerp_lanes(fz, lerp_lanes(fy, read(x), read(x + step.y)),
                            lerp_lanes(fy, read(x + step.z), read(x + step.z + step.y)));
        };
        double* sum = values.sum[c / block_size] + block_size * run->voxel + c % block_size;
        const auto value = lerp_lanes(fx, column(0), column(step.x));
        hn::StoreU(hn::Add(hn::LoadU(d, sum), value), d, sum);
      }
    }
  }
}

/// Neighbors along x of as many samples as WideTag has lanes, as float64 in adjacent lanes.
struct WidePairs {
  hn::Vec<WideTag> half[2];
};

template <bool is_end, class T>
HWY_INLINE WidePairs read_wide_pairs(const T* samples,
                                     const std::int32_t* offset,
                                     const std::ptrdiff_t* x) {
  const WideTag d;
  constexpr std::size_t lanes = hn::MaxLanes(WideTag());
  if constexpr (!is_end && (sizeof(T) <= 2 || std::is_same_v<T, float>)) {
    constexpr std::size_t pairs = hn::MaxLanes(PairTag());
    const auto low = read_pairs(samples, offset);
    if constexpr (2 * pairs == lanes) {
      return {{hn::PromoteTo(d, low), hn::PromoteTo(d, read_pairs(samples, offset + pairs))}};
    } else {
      const hn::Half<PairFloatTag> half;
      return {
          {hn::PromoteTo(d, hn::LowerHalf(half, low)), hn::PromoteTo(d, hn::UpperHalf(half, low))}};
    }
  } else {
    alignas(64) double pairs[2 * lanes];
    for (std::size_t s = 0; s < lanes; ++s) {
      pairs[2 * s] = static_cast<double>(samples[offset[s]]);
      pairs[2 * s + 1] = static_cast<double>(samples[offset[s] + (is_end ? x[s] : 1)]);
    }
    return {{hn::Load(d, pairs), hn::Load(d, pairs + lanes)}};
  }
}

/// Successive numbers, each twice.
HWY_INLINE WidePairs both_wide(const double* from) {
  const WideTag d;
  constexpr std::size_t lanes = hn::MaxLanes(WideTag());
  alignas(64) static constexpr std::int64_t order[8] = {0, 0, 1, 1, 2, 2, 3, 3};
  const auto twice = hn::SetTableIndices(d, order);
  return {{hn::TableLookupLanes(hn::LoadU(d, from), twice),
           hn::TableLookupLanes(hn::LoadU(d, from + lanes / 2), twice)}};
}

/// Values of all samples of one component.
/// @param value  out, shape [taps.count], padded to a vector
template <bool is_end, class T>
inline void sample_wide_pairs(const SourceView<T>& view, const WideTaps& taps, double* value) {
  const WideTag d;
  constexpr int lanes = static_cast<int>(hn::MaxLanes(WideTag()));
  const UpperSteps all = {1, view.dims[0], std::ptrdiff_t{view.dims[0]} * view.dims[1]};
  for (int s = 0; s < taps.count; s += lanes) {
    WidePairs line[4];  // (y, z), (y+1, z), (y, z+1), (y+1, z+1)
    if constexpr (is_end) {
      std::int32_t offset[4][lanes];
      std::ptrdiff_t x[lanes];
      for (int lane = 0; lane < lanes; ++lane) {
        const UpperSteps step = steps_within(all, taps, s + lane);
        x[lane] = step.x;
        for (int l = 0; l < 4; ++l) {
          offset[l][lane] = taps.offset[s + lane] +
                            static_cast<std::int32_t>((l % 2) * step.y + (l / 2) * step.z);
        }
      }
      for (int l = 0; l < 4; ++l) line[l] = read_wide_pairs<true>(view.data, offset[l], x);
    } else {
      for (int l = 0; l < 4; ++l) {
        const T* samples = view.data + ((l % 2) * all.y + (l / 2) * all.z);
        line[l] = read_wide_pairs<false>(samples, taps.offset + s, nullptr);
      }
    }
    const WidePairs fy = both_wide(taps.fraction[1] + s), fz = both_wide(taps.fraction[2] + s);
    hn::Vec<WideTag> column[2];
    for (int h = 0; h < 2; ++h) {
      const auto near = lerp_lanes(fy.half[h], line[0].half[h], line[1].half[h]);
      const auto next = lerp_lanes(fy.half[h], line[2].half[h], line[3].half[h]);
      column[h] = lerp_lanes(fz.half[h], near, next);
    }
    hn::StoreU(
        lerp_lanes(hn::LoadU(d, taps.fraction[0] + s), hn::ConcatEven(d, column[1], column[0]),
                   hn::ConcatOdd(d, column[1], column[0])),
        d, value + s);
  }
}

/// Adds samples of one component.
template <bool is_end, class T>
inline void add_single(const SourceView<T>& view,
                       const WideTaps& taps,
                       const WideRun* runs,
                       int run_count,
                       WideValues& values) {
  alignas(64) double value[WideTaps::padded];
  sample_wide_pairs<is_end>(view, taps, value);
  for (const WideRun* run = runs; run < runs + run_count; ++run) {
    double sum = values.sum[0][run->voxel];
    for (int s = run->first; s < run->first + run->count; ++s) {
      if (taps.is_inside[s] == 0) continue;
      ++values.samples[run->voxel];
      sum += value[s];
    }
    values.sum[0][run->voxel] = sum;
  }
}

/// Whether reading around the samples could pass the end of the source. Fills the padding of
/// `taps`, which is read too.
template <class T>
inline bool meets_end(const SourceView<T>& view, WideTaps& taps) {
  for (int s = taps.count; s < taps.count + cell_edge; ++s) {
    taps.offset[s] = 0;
    for (auto& fraction : taps.fraction) fraction[s] = 0;
  }
  const std::int64_t line = view.dims[0], slice = line * view.dims[1];
  // A vector extends up to seven bytes or three samples beyond the upper neighbor.
  constexpr std::int64_t spare = 8;
  const std::int64_t past = slice * view.dims[2] - (slice + line + 1 + spare);
  std::int32_t last = 0;
  for (int s = 0; s < taps.count; ++s) last = std::max(last, taps.offset[s]);
  return last >= past;
}

/// Adds the samples of `taps` to the sums of their voxels, in their order.
template <class T>
HWY_NOINLINE void add_samples(const SourceView<T>& view,
                              WideTaps& taps,
                              const WideRun* runs,
                              int run_count,
                              WideValues& values) {
  if (taps.count == 0) return;
  const bool is_end = meets_end(view, taps);
  if (view.components == 1) {
    is_end ? add_single<true>(view, taps, runs, run_count, values)
           : add_single<false>(view, taps, runs, run_count, values);
  } else {
    is_end ? add_components<true>(view, taps, runs, run_count, values)
           : add_components<false>(view, taps, runs, run_count, values);
  }
  taps.count = 0;
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard

/// @file volume_range.hpp
/// The smallest and largest sample of each component, to which overshooting filters are clamped.
#pragma once
#include <cstdint>
#include <limits>
#include <vector>

#include "kernels/base/hd.hpp"
#include "kernels/base/view.hpp"
#include "kernels/warp/sample/volume_sample.hpp"

namespace tetwarp {

/// One index = part_voxels consecutive voxels of the source; any order.
template <class T>
struct VolumeRangeOp {
  using Real = ArithmeticOf<T>;
  static constexpr std::int64_t part_voxels = 4096;
  static constexpr Real beyond = std::numeric_limits<Real>::infinity();
  SourceView<T> source;
  std::int64_t voxel_count;
  View<Real> ranges;  ///< smallest and largest per part and component, NaN ignored

  TETWARP_HD void operator()(std::int64_t part) const {
    const std::int64_t end = min_of((part + 1) * part_voxels, voxel_count);
    for (int c = 0; c < source.components; ++c) {
      Real low = beyond, high = -beyond;
      for (std::int64_t voxel = part * part_voxels; voxel < end; ++voxel) {
        const Real sample = static_cast<Real>(source.data[voxel * source.components + c]);
        low = sample < low ? sample : low;
        high = sample > high ? sample : high;
      }
      ranges[2 * (part * source.components + c)] = low;
      ranges[2 * (part * source.components + c) + 1] = high;
    }
  }
};

/// Finds the range of a source. Waits for the result.
///
/// @param exec    where to run
/// @param source  the samples
/// @returns smallest and largest sample per component, NaN ignored; +inf and -inf for a component
///          that is NaN everywhere
///
/// Determinism: same bits on every back end. Cost: one read of the source.
/// Source: ours.
template <class Exec, class T>
std::vector<ArithmeticOf<T>> volume_range(Exec& exec, const SourceView<T>& source) {
  using Real = ArithmeticOf<T>;
  const std::int64_t voxels = std::int64_t{source.dims[0]} * source.dims[1] * source.dims[2];
  const std::int64_t parts =
      (voxels + VolumeRangeOp<T>::part_voxels - 1) / VolumeRangeOp<T>::part_voxels;
  const auto entries = static_cast<std::size_t>(2 * source.components);
  typename Exec::template Buffer<Real> buffer;
  std::vector<Real> ranges(static_cast<std::size_t>(parts) * entries);
  buffer.reserve(parts * 2 * source.components);
  const View<Real> found = buffer.view(parts * 2 * source.components);
  exec.for_each("warp/setup", parts, VolumeRangeOp<T>{source, voxels, found});
  exec.get(View<const Real>(found), ranges.data());
  for (std::size_t r = entries; r < ranges.size(); ++r) {
    Real& bound = ranges[r % entries];
    bound = r % 2 == 0 ? min_of(bound, ranges[r]) : max_of(bound, ranges[r]);
  }
  ranges.resize(entries);
  return ranges;
}

}  // namespace tetwarp

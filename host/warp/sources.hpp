/// @file sources.hpp
/// The sources in the memory of an executor, with data derived from them on first use: spline
/// coefficients, ranges, constant regions.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <tuple>
#include <type_traits>
#include <vector>

#include "host/base/warp_backend.hpp"
#include "host/warp/geometry.hpp"
#include "kernels/warp/sample/packed_source.hpp"
#include "kernels/warp/sample/volume_prefilter.hpp"
#include "kernels/warp/sample/volume_range.hpp"
#include "kernels/warp/volume_uniform.hpp"

namespace tetwarp {

/// Uploads a plan's sources once.
template <class Exec>
class WarpSources {
 public:
  /// The arguments must outlive the object: a cpu executor reads their memory in place.
  WarpSources(Exec& exec, const WarpPlan& plan)
      : exec_(exec), plan_(plan), sources_(plan.sources.size()) {
    for (std::size_t s = 0; s < sources_.size(); ++s) {
      const VolumeView& source = plan.sources[s];
      const std::byte* data = static_cast<const std::byte*>(source.data);
      const std::int64_t bytes = entry_count(s) * static_cast<std::int64_t>(size_of(source.type));
      sources_[s].data = source.memory == Memory::device
                             ? data
                             : exec_.resident("warp/upload", data, bytes, sources_[s].buffer).data;
    }
  }

  std::size_t size() const { return sources_.size(); }

  /// Whether the caller's device memory holds a source.
  bool are_on_device() const {
    return std::any_of(plan_.sources.begin(), plan_.sources.end(),
                       [](const VolumeView& source) { return source.memory == Memory::device; });
  }

  /// Samples of source s, of type T, with the coefficients and range that the filter needs.
  template <class T>
  SourceView<T> view(std::size_t s) {
    SourceView<T> view =
        source_view<T>(plan_.source_region, plan_.sources[s].components, sources_[s].data);
    const Filter filter = plan_.options.filter;
    if constexpr (can_blend<T>) {
      if (!is_wide(filter) || filter == Filter::labels) return view;
      if (filter == Filter::bspline) view.coefficients = coefficients(s, view);
      if (plan_.options.overshoot == Overshoot::clamp) view.range = range(s, view);
    }
    return view;
  }

  /// Source s packed, from its first use on; null where that would take more than a tenth of the
  /// device's free memory.
  template <class T>
  const PackedSample<T>* packed(std::size_t s, const SourceView<T>& view) {
    Source& source = sources_[s];
    const std::int64_t voxels = plan_.source_region.voxel_count();
    const auto bytes = static_cast<std::int64_t>(sizeof(PackedSample<T>)) * voxels;
    const bool is_first = !source.is_packed.has_value();
    if (is_first) {
      source.is_packed =
          static_cast<double>(bytes) <= free_device_memory(plan_.options.device) / 10;
    }
    if (!*source.is_packed) return nullptr;
    source.packed.reserve(bytes);
    auto* const samples = reinterpret_cast<PackedSample<T>*>(source.packed.view(bytes).data);
    if (is_first) pack_source(exec_, PackSourceOp<T>{view, {samples, voxels}});
    return samples;
  }

  /// The regions where source s, or the coefficients that the filter reads, have one value; an
  /// empty map when no cell can be filled.
  /// @param tets, rest  as in volume_uniform()
  template <class T>
  UniformMap uniform_map(std::size_t s,
                         const SourceView<T>& view,
                         View<const std::int32_t> tets,
                         View<const Node> rest) {
    std::optional<UniformMap>& known = sources_[s].uniform;
    if (known) return *known;
    if (view.coefficients == nullptr) {
      known = find_uniform(s, view, tets, rest);
    } else {
      SourceView<ArithmeticOf<T>> read;
      read.data = view.coefficients;
      for (int axis = 0; axis < 3; ++axis) {
        read.dims[axis] = view.dims[axis];
        read.origin[axis] = view.origin[axis];
      }
      read.components = view.components;
      known = find_uniform(s, read, tets, rest);
    }
    return *known;
  }

 private:
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  /// Derived data in the arithmetic of the source's type, float or double.
  template <class Real>
  struct Found {
    Buffer<Real> coefficients;
    bool has_coefficients = false;
    std::vector<Real> range;
    Buffer<Real> range_buffer;
    const Real* range_data = nullptr;
  };

  struct Source {
    const std::byte* data = nullptr;
    Buffer<std::byte> buffer, packed;
    std::optional<bool> is_packed;
    Buffer<std::uint8_t> reach;
    std::optional<UniformMap> uniform;
    std::tuple<Found<float>, Found<double>> found;
  };

  std::int64_t entry_count(std::size_t s) const {
    return plan_.source_region.voxel_count() * plan_.sources[s].components;
  }

  template <class T>
  const ArithmeticOf<T>* coefficients(std::size_t s, const SourceView<T>& view) {
    using Real = ArithmeticOf<T>;
    auto& found = std::get<Found<Real>>(sources_[s].found);
    const std::int64_t entries = entry_count(s);
    if (!found.has_coefficients) {
      found.coefficients.reserve(entries);
      const View<Real> to = found.coefficients.view(entries);
      // Below the rounding of a value: keeps constant regions of the source constant.
      constexpr double share = std::numeric_limits<Real>::epsilon() / 4;
      double largest = 0;
      range(s, view);
      for (const Real bound : found.range) largest = max_of(largest, double{fabs(bound)});
      const double tolerance = std::isfinite(largest) ? share * largest : 0;
      if constexpr (std::is_same_v<Real, double>) {
        volume_prefilter(exec_, view, tolerance, to, to);
      } else {
        Buffer<double> work;
        work.reserve(entries);
        volume_prefilter(exec_, view, tolerance, work.view(entries), to);
        Real first;
        exec_.get(View<const Real>{to.data, 1},
                  &first);  // waits until the scratch memory is no longer in use
      }
      found.has_coefficients = true;
    }
    return found.coefficients.view(entries).data;
  }

  template <class T>
  const ArithmeticOf<T>* range(std::size_t s, const SourceView<T>& view) {
    auto& found = std::get<Found<ArithmeticOf<T>>>(sources_[s].found);
    if (found.range_data == nullptr) {
      if (plan_.options.source_window) {
        for (const double bound : plan_.options.source_window->ranges[s]) {
          found.range.push_back(static_cast<ArithmeticOf<T>>(bound));
        }
      } else {
        found.range = volume_range(exec_, view);
      }
      found.range_data =
          exec_
              .resident("warp/setup", found.range.data(),
                        static_cast<std::int64_t>(found.range.size()), found.range_buffer)
              .data;
    }
    return found.range_data;
  }

  template <class T>
  UniformMap find_uniform(std::size_t s,
                          const SourceView<T>& view,
                          View<const std::int32_t> tets,
                          View<const Node> rest) {
    UniformMap map = make_uniform_map(view);
    const std::int64_t blocks = map.block_count();
    Buffer<std::uint8_t> scratch;
    Buffer<std::int64_t> extended_count;
    sources_[s].reach.reserve(blocks);
    scratch.reserve(blocks);
    extended_count.reserve(1);
    exec_.zero("warp/setup", extended_count.view(1));
    volume_uniform(exec_, view, tets, rest, sources_[s].reach.view(blocks), scratch.view(blocks),
                   extended_count.view(1));
    std::int64_t count = 0;
    exec_.get(extended_count.const_view(1), &count);
    if (count > 0) map.reach = sources_[s].reach.const_view(blocks);
    return map;
  }

  Exec& exec_;
  const WarpPlan& plan_;
  std::vector<Source> sources_;
};

}  // namespace tetwarp

/// @file totals.hpp
/// Integrals of the sources over the mesh at rest, and of the outputs, when intensities are
/// densities or conservative; for any executor.
#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/base/warp_backend.hpp"
#include "host/warp/geometry.hpp"
#include "host/warp/stages/pairs.hpp"
#include "kernels/warp/overlap/volume_total.hpp"

namespace tetwarp {

/// Computes the numbers of Totals.
template <class Exec>
class WarpTotals {
 public:
  /// The arguments must outlive the object.
  WarpTotals(Exec& exec, const WarpPlan& plan, const WarpGeometry& geometry)
      : exec_(exec), plan_(plan), geometry_(geometry) {
    if (plan.options.intensity == Intensity::value || plan.options.source_window) return;
    firsts_.push_back(0);
    for (const VolumeView& source : plan.sources) {
      firsts_.push_back(firsts_.back() + source.components);
    }
    sums_.reserve(firsts_.back());
  }

  bool are_requested() const { return !firsts_.empty(); }

  /// Sums output s of this step, and in the first step also source s.
  void run(std::size_t s, NumberView source, NumberView output, const WarpPairs<Exec>& pairs) {
    const int components = plan_.sources[s].components;
    if (std::ssize(before_) == firsts_[s]) add_before(components, source, pairs);
    sum(output, geometry_.frame.voxel_count(), components,
        {sums_.view(firsts_.back()).data + firsts_[s], components});
  }

  /// Copies the sums of the outputs to the host, after all preceding stages.
  void fetch(typename Exec::template PinnedBuffer<double>& sums) {
    sums.reserve(firsts_.back());
    exec_.fetch(sums_.const_view(firsts_.back()), sums);
  }
  /// Sets the integrals before and after a step from its sums.
  void report(const typename Exec::template PinnedBuffer<double>& sums, Totals& totals) const {
    totals.before = before_;
    for (std::int64_t c = 0; c < firsts_.back(); ++c) {
      totals.after.push_back(sums.const_view(firsts_.back())[c] * output_voxel());
    }
  }
  /// Volume of an output voxel [world].
  double output_voxel() const { return 1 / std::abs(determinant(geometry_.axes.output_index)); }

 private:
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  /// Waits for the result.
  void add_before(int components, NumberView source, const WarpPairs<Exec>& pairs) {
    OutputFrame frame = {};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      frame.end[axis] = static_cast<int>(plan_.sources.front().grid.dims[axis]);
    }
    Buffer<std::int64_t> offsets;
    offsets.reserve(pairs.tet_count() + 1);
    exec_.for_each(
        "warp/setup", pairs.tet_count(),
        TetSliceCountOp{pairs.tets(), pairs.rest(), frame, offsets.view(pairs.tet_count())});
    exec_.exclusive_scan("warp/setup", offsets.view(pairs.tet_count() + 1));
    std::int64_t slices = 0;
    exec_.get(View<const std::int64_t>{offsets.const_view(0).data + pairs.tet_count(), 1}, &slices);
    std::vector<double> totals(static_cast<std::size_t>(components), 0.0);
    if (slices > 0) {
      Buffer<double> masses, total;
      masses.reserve(slices * components);
      total.reserve(components);
      exec_.for_each_item("warp/setup", offsets.const_view(pairs.tet_count() + 1), slices,
                          TetSliceMassOp{pairs.tets(), pairs.rest(), frame, source, components,
                                         masses.view(slices * components)});
      sum({masses.view(0).data, PixelType::float64}, slices, components, total.view(components));
      exec_.get(total.const_view(components), totals.data());
    }
    const double voxel = std::abs(determinant(geometry_.axes.source));
    for (const double total : totals) before_.push_back(total * voxel);
  }

  void sum(NumberView numbers, std::int64_t voxels, int components, View<double> totals) {
    const std::int64_t size = 2 * components * volume_part_count(voxels);
    scratch_.reserve(size);
    volume_total(exec_, numbers, voxels, components, scratch_.view(size), totals);
  }

  Exec& exec_;
  const WarpPlan& plan_;
  const WarpGeometry& geometry_;
  std::vector<int> firsts_;     ///< place of each source's first component in the lists, then the
                                ///< number of all; empty: totals are not computed
  std::vector<double> before_;  ///< integrals of the sources, component by component [world]
  Buffer<double> sums_;
  Buffer<double> scratch_;
};

}  // namespace tetwarp

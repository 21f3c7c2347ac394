/// @file roundings.hpp
/// What storing conservative intensities as integers changes in their totals; for any executor.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/base/warp_backend.hpp"
#include "host/warp/geometry.hpp"
#include "kernels/warp/overlap/voxel_rounding.hpp"

namespace tetwarp {

/// Keeps the changes of every cell from step to step, because steps write only some cells again.
template <class Exec>
class WarpRoundings {
 public:
  /// The arguments must outlive the object.
  WarpRoundings(Exec& exec, const WarpPlan& plan, const WarpGeometry& geometry)
      : exec_(exec), plan_(plan), geometry_(geometry), sizes_(plan.sources.size()) {
    if (plan.options.intensity != Intensity::conservative) return;
    const std::int64_t cells = geometry.frame.cell_count();
    firsts_.push_back(0);
    for (std::size_t s = 0; s < plan.sources.size(); ++s) {
      const VolumeView& source = plan.sources[s];
      firsts_.push_back(firsts_.back() + source.components);
      if (is_integer(source.type)) sizes_[s] = cells * source.components;
      buffers_.emplace_back().reserve(sizes_[s]);
    }
    sums_.reserve(firsts_.back());
  }

  bool are_requested() const { return !firsts_.empty(); }

  /// Begins output s of a step.
  /// @param cell_work  cells to keep, as in RasterGeometry
  VoxelRounding begin(std::size_t s, View<const std::int64_t> cell_work, NumberView volume) {
    const View<RoundingChange> changes = buffers_[s].view(sizes_[s]);
    const int components = plan_.sources[s].components;
    const std::int64_t cells = changes.size / components;
    exec_.for_each("warp/raster", cells, RoundingClearOp{cell_work, components, changes});
    const auto& dims = plan_.output_grid.dims;
    return {geometry_.frame, {dims[0], dims[1]}, components, volume, changes};
  }

  /// Sums the changes of output s after its voxels are stored.
  void sum(std::size_t s) {
    const int components = plan_.sources[s].components;
    const View<RoundingChange> sums = {sums_.view(firsts_.back()).data + firsts_[s], components};
    exec_.zero("warp/raster", sums);
    const std::int64_t cells = sizes_[s] / components;
    exec_.for_each("warp/raster", (cells + RoundingSumOp::cells - 1) / RoundingSumOp::cells,
                   RoundingSumOp{buffers_[s].const_view(sizes_[s]), components, sums});
  }

  /// Copies the sums to the host, after all preceding stages.
  void fetch(typename Exec::template PinnedBuffer<RoundingChange>& sums) {
    sums.reserve(firsts_.back());
    exec_.fetch(sums_.const_view(firsts_.back()), sums);
  }
  /// Adds the sums of a step to its report.
  /// @param voxel  volume of an output voxel [world]
  void report(const typename Exec::template PinnedBuffer<RoundingChange>& sums,
              double voxel,
              StepReport& report) const {
    for (std::int64_t c = 0; c < firsts_.back(); ++c) {
      const RoundingChange& sum = sums.const_view(firsts_.back())[c];
      const double rounding = static_cast<double>(sum.rounding) * RoundingChange::quantum;
      report.totals.rounding.push_back(rounding * voxel);
      report.totals.clipping.push_back(static_cast<double>(sum.clipping) * voxel);
      report.counts.values_clipped += sum.clipped;
    }
  }

 private:
  Exec& exec_;
  const WarpPlan& plan_;
  const WarpGeometry& geometry_;
  std::vector<std::int64_t> sizes_;  ///< of the lists of changes, per source
  std::vector<int> firsts_;          ///< place of each source's first component in the sums, then
                                     ///< the number of all; empty: nothing is requested
  std::vector<typename Exec::template Buffer<RoundingChange>> buffers_;  ///< [cell][component]
  typename Exec::template Buffer<RoundingChange> sums_;  ///< of the components of all outputs
};

}  // namespace tetwarp

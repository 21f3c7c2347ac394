/// @file counter_totals.hpp
/// The last stage of a step: sums its counters to memory of the host.
#pragma once
#include <cstdint>

#include "host/warp/step_counters.hpp"
#include "kernels/base/grouped_sums.hpp"

namespace tetwarp {

/// Sums the counters of steps whose output has `cells` cells.
template <class Exec>
class CounterTotals {
 public:
  /// The executor must outlive the object.
  CounterTotals(Exec& exec, std::int64_t cells)
      : exec_(exec),
        parts_((cells + CoveredTotalOp::covered_cells - 1) / CoveredTotalOp::covered_cells) {
    within_.reserve(parts_ + 1);
    groups_.reserve(group_count(parts_) + 1);
  }

  /// @param cell_covered  covered voxels per cell where some cells were kept, else of size 0
  /// @param totals        page-locked memory of the host
  void run(const CounterMemory* counters,
           View<const std::uint16_t> cell_covered,
           StepCounters* totals) {
    const CounterTotalOp total{counters, {reinterpret_cast<std::int64_t*>(totals), counter_words}};
    if (cell_covered.size == 0) {
      exec_.for_each("warp/raster", counter_words, total);
    } else {
      exec_.grouped_scan(
          "warp/raster", parts_, CoveredTotalOp{cell_covered, total},
          {within_.view(parts_ + 1), groups_.view(group_count(parts_) + 1), parts_ + 1});
    }
  }

 private:
  Exec& exec_;
  std::int64_t parts_;
  typename Exec::template Buffer<std::int64_t> within_, groups_;  ///< scratch of the sum
};

}  // namespace tetwarp

/// @file feature_gaps.hpp
/// FeatureGaps: the nearest of pairs of features.
#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "kernels/collide/pair_gap.hpp"

namespace tetwarp {

/// @tparam Exec  CpuExec or CudaExec
template <class Exec>
class FeatureGaps {
 public:
  explicit FeatureGaps(Exec& exec) : exec_(exec) {}

  /// At the start of a motion; the first in sorted order among equals.
  /// @param pairs  at least one
  PairGap nearest(const CollideView& scene,
                  const MotionView& motion,
                  View<const FeaturePair> pairs) {
    const std::int64_t runs = (pairs.size + gap_run - 1) / gap_run;
    exec_.resize(gaps_, runs);
    exec_.for_each("collide/pair_gap", runs, PairGapOp{scene, motion, pairs, exec_.view(gaps_)});
    const View<const PairGap> gaps = exec_.on_host(exec_.view(std::as_const(gaps_)), host_gaps_);
    PairGap nearest = gaps[0];
    for (std::int64_t r = 1; r < gaps.size; ++r) {
      if (is_nearer(gaps[r], nearest)) nearest = gaps[r];
    }
    return nearest;
  }

 private:
  Exec& exec_;
  typename Exec::template Vector<PairGap> gaps_;  ///< the nearest of each run of pairs
  std::vector<PairGap> host_gaps_;
};

}  // namespace tetwarp

/// @file feature_touches.hpp
/// FeatureTouches: when the features of pairs touch during a motion.
#pragma once
#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "host/collide/detector.hpp"
#include "kernels/collide/pair_touch.hpp"

namespace tetwarp {

/// @tparam Exec  CpuExec or CudaExec
template <class Exec>
class FeatureTouches {
 public:
  explicit FeatureTouches(Exec& exec) : exec_(exec) {}

  /// Finds the pairs that touch or are near at the start, as TouchFilterOp.
  void find(const CollideView& scene,
            const MotionView& motion,
            const CcdLimits& limits,
            double near_at_start,
            View<const FeaturePair> pairs,
            View<const std::uint8_t> is_still,
            DetectionCounts& counts) {
    exec_.resize(results_, pairs.size);
    exec_.for_each("collide/pair_touch", pairs.size,
                   PairTouchOp{scene, motion, limits, pairs, exec_.view(results_)});
    exec_.append(
        "collide/pair_touch", pairs.size,
        TouchFilterOp{scene, is_still, pairs, exec_.view(std::as_const(results_)), near_at_start},
        touches_);
    counts.evaluations += touches_.tally();
  }

  View<const FeatureTouch> view() const { return touches_.view(); }

  /// On the host, sorted; valid until the next call.
  const std::vector<TouchingPair>& sorted() {
    const View<const FeatureTouch> touches = exec_.on_host(touches_.view(), host_touches_);
    sorted_.clear();
    for (std::int64_t k = 0; k < touches.size; ++k) {
      const FeatureTouch& touch = touches[k];
      sorted_.push_back(
          {touch.pair.kind, touch.pair.a, touch.pair.b, touch.time, touch.start_distance});
    }
    std::sort(sorted_.begin(), sorted_.end());
    return sorted_;
  }

 private:
  Exec& exec_;
  typename Exec::template Vector<CcdResult> results_;
  typename Exec::template List<FeatureTouch> touches_;
  std::vector<FeatureTouch> host_touches_;
  std::vector<TouchingPair> sorted_;
};

}  // namespace tetwarp

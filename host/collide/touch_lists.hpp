/// @file touch_lists.hpp
/// TouchLists: the touches of the pairs of a step, in memory of an executor.
#pragma once
#include <array>
#include <cstdint>
#include <utility>

#include "kernels/collide/touch_stages.hpp"

namespace tetwarp {

/// Two capsules side by side have two more touches than their pair, at the ends of their overlap.
/// @tparam Exec  CpuExec or CudaExec
template <class Exec>
class TouchLists {
 public:
  /// @param has_capsules  false: no pair of the scene has touches at ends of overlaps
  TouchLists(Exec& exec, bool has_capsules) : exec_(exec), has_capsules_(has_capsules) {}

  void clear() {
    exec_.resize(first_, 0);
    first_ends_.clear();
    later_count_ = 0;
  }

  /// Makes the touches of the first detection of a step.
  void set_first(View<const FeatureTouch> pairs, const TouchView& view) {
    make(pairs, view, 0, first_, first_ends_);
  }
  /// Makes the touches of a later detection and adds them.
  /// @param pass  number of the detection in the step, from 1
  void add_later(View<const FeatureTouch> pairs, const TouchView& view, std::int32_t pass) {
    make(pairs, view, pass, fresh_, fresh_ends_);
    const View<const PairTouch> fresh = exec_.view(std::as_const(fresh_));
    const std::int64_t count = later_count_ + fresh.size + fresh_ends_.size();
    Vector& joined = later_[1 - later_now_];
    exec_.resize(joined, count + count / 2);
    exec_.for_each(label, count,
                   TouchCopyOp{{later(), fresh, fresh_ends_.view()}, exec_.view(joined)});
    later_now_ = 1 - later_now_;
    later_count_ = count;
  }

  /// Of the first detection, in the order of its pairs.
  View<PairTouch> first() { return exec_.view(first_); }
  View<const PairTouch> first() const { return exec_.view(first_); }
  TouchList view() const { return {exec_.view(first_), first_ends_.view(), later()}; }

 private:
  using Vector = typename Exec::template Vector<PairTouch>;
  using List = typename Exec::template List<PairTouch>;
  static constexpr const char* label = "collide/touches";

  /// @param touches, ends  out: of the pairs, and at ends of overlaps
  void make(View<const FeatureTouch> pairs,
            const TouchView& view,
            std::int32_t pass,
            Vector& touches,
            List& ends) {
    exec_.resize(touches, pairs.size);
    exec_.for_each(label, pairs.size, TouchOp{pairs, view, pass, exec_.view(touches)});
    ends.clear();
    if (!has_capsules_) return;
    exec_.append(label, pairs.size,
                 EndTouchOp{pairs, exec_.view(std::as_const(touches)), view, pass}, ends);
  }
  View<const PairTouch> later() const {
    return {exec_.view(later_[later_now_]).data, later_count_};
  }

  Exec& exec_;
  bool has_capsules_;
  Vector first_;
  List first_ends_;
  std::array<Vector, 2> later_;  ///< of later detections in one of both, the other is for copies
  std::size_t later_now_ = 0;    ///< the one that holds them
  std::int64_t later_count_ = 0;
  Vector fresh_;  ///< of the detection that is added
  List fresh_ends_;
};

}  // namespace tetwarp

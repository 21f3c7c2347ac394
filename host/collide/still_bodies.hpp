/// @file still_bodies.hpp
/// StillBodies: the bodies that do not move, and those of them that a moving body reaches.
#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/collide/pair_touch.hpp"

namespace tetwarp {

/// @tparam Exec  CpuExec or CudaExec
template <class Exec>
class StillBodies {
 public:
  explicit StillBodies(Exec& exec) : exec_(exec) {}

  /// @param is_still  [bodies], or empty: none
  void set(std::span<const std::uint8_t> is_still) {
    host_.assign(is_still.begin(), is_still.end());
    exec_.put(host_, own_);
  }

  bool are_none() const { return host_.empty(); }
  std::span<const std::uint8_t> host() const { return host_; }
  View<const std::uint8_t> view() const { return exec_.view(own_); }

  /// Sets reached() from the pairs of a detection.
  void find_reached(const CollideView& scene, View<const FeatureTouch> touches) {
    reached_.clear();
    if (are_none()) return;
    exec_.append("collide/touches", touches.size, ReachedOp{scene, view(), touches}, list_);
    const View<const std::int32_t> found = exec_.on_host(list_.view(), host_list_);
    reached_.assign(found.data, found.data + found.size);
    std::ranges::sort(reached_);
    reached_.erase(std::ranges::unique(reached_).begin(), reached_.end());
  }
  /// As Detector::reached().
  const std::vector<std::int32_t>& reached() const { return reached_; }

 private:
  Exec& exec_;
  std::vector<std::uint8_t> host_;                    ///< [bodies], or empty
  typename Exec::template Vector<std::uint8_t> own_;  ///< the same, in memory of the executor
  typename Exec::template List<std::int32_t> list_;
  std::vector<std::int32_t> host_list_, reached_;
};

}  // namespace tetwarp

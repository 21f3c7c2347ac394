/// @file thinned_event_log.cuh
/// ThinnedEventLog: the log of residuals of a solve within one launch.
#pragma once
#include <cstdint>

#include "kernels/contact/contact_methods.hpp"

namespace tetwarp {

/// Stores the last measured residual and an evenly spaced selection of those before it. One thread
/// writes.
class ThinnedEventLog {
 public:
  /// @param events  room for two or more
  /// @param writes  whether this thread is the one that writes
  __device__ ThinnedEventLog(View<ContactEvent> events, bool writes)
      : events_(events), writes_(writes) {}

  __device__ void note(const ContactEvent& event) {
    last_ = event;
    is_last_kept_ = seen_++ % stride_ == 0;
    if (!is_last_kept_) return;
    if (count_ == events_.size) {
      for (std::int64_t k = 1; 2 * k < count_ && writes_; ++k) events_[k] = events_[2 * k];
      count_ = (count_ + 1) / 2;
      stride_ *= 2;
      is_last_kept_ = (seen_ - 1) % stride_ == 0;
      if (!is_last_kept_) return;
    }
    if (writes_) events_[count_] = event;
    ++count_;
  }
  /// A solve within one launch is not interrupted.
  __device__ bool stops() const { return false; }
  /// @return  how many residuals are kept
  __device__ std::int64_t end() {
    if (seen_ > 0 && !is_last_kept_) {
      count_ = min_of(count_ + 1, events_.size);
      if (writes_) events_[count_ - 1] = last_;
    }
    return count_;
  }

 private:
  View<ContactEvent> events_;
  bool writes_;
  std::int64_t count_ = 0, stride_ = 1, seen_ = 0;
  ContactEvent last_ = {};
  bool is_last_kept_ = true;
};

}  // namespace tetwarp

/// @file step_queue.hpp
/// The steps in flight of a Warper: their order, their errors, and which parts of them overlap.
#pragma once
#include <chrono>
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <vector>

#include "host/base/warp_backend.hpp"

namespace tetwarp {

/// Calls the parts of WarpBackend so that the download of a step overlaps with the kernels of the
/// next. Arguments have been checked.
class StepQueue {
 public:
  explicit StepQueue(std::unique_ptr<WarpBackend> backend);
  StepQueue(const StepQueue&) = delete;
  StepQueue& operator=(const StepQueue&) = delete;
  ~StepQueue();

  const WarpBackend& backend() const { return *backend_; }
  std::size_t size() const { return flights_.size(); }

  /// True when a step in flight writes to memory of this target.
  bool writes_to(const WarpTarget& target) const;

  /// Starts a step. Its errors are stored, and thrown by finish().
  /// @pre size() < 2
  void begin(const PositionsView& deformed, const WarpTarget& target, const Progress& progress);

  /// Ends the oldest step, which is no longer in flight afterwards, even when the call throws.
  /// @throws the first error of this step
  /// @pre size() > 0
  StepReport finish();

 private:
  struct Flight {
    int number;  ///< 0 or 1, the argument of WarpBackend's functions
    std::vector<void*> volumes;
    WarpTarget target;  ///< its span refers to `volumes`
    std::chrono::steady_clock::time_point start;
    bool is_settled = false;
    std::exception_ptr error = {};
  };

  /// Runs a part of a step, unless an earlier part failed.
  static void attempt(Flight& flight, const std::function<void()>& part);
  void settle(Flight& flight);

  std::unique_ptr<WarpBackend> backend_;
  std::vector<std::unique_ptr<Flight>> flights_;  ///< oldest first
};

}  // namespace tetwarp

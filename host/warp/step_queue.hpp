/// @file step_queue.hpp
/// The steps in flight of a Warper: their order, their errors, and what runs beside what.
#pragma once
#include <chrono>
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <vector>

#include "host/base/warp_backend.hpp"

namespace tetwarp {

/// Drives a back end so that the download of a step runs beside the kernels of the next. Arguments
/// have been checked.
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

  /// Starts a step; fewer than two are in flight. What goes wrong is kept for finish().
  void begin(const PositionsView& deformed, const WarpTarget& target, const Progress& progress);

  /// Ends the oldest step, in flight no longer whether it throws or not.
  /// @throws what went wrong with this step
  StepReport finish();

 private:
  struct Flight {
    int number;  ///< 0 or 1, as the back end knows it
    std::vector<void*> volumes;
    WarpTarget target;  ///< of these volumes
    std::chrono::steady_clock::time_point start;
    bool is_settled = false;
    std::exception_ptr error = {};
  };

  /// Does a part of a step, unless an earlier part failed.
  static void attempt(Flight& flight, const std::function<void()>& part);
  void settle(Flight& flight);

  std::unique_ptr<WarpBackend> backend_;
  std::vector<std::unique_ptr<Flight>> flights_;  ///< oldest first
};

}  // namespace tetwarp

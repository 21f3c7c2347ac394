/// @file step_count.hpp
/// StepCount: how many steps are done, and how far the running one is.
#pragma once
#include <cstdint>
#include <functional>
#include <utility>

#include <tetwarp/simulate.hpp>

namespace tetwarp {

class StepCount {
 public:
  /// @param time_step  of the scene [s]
  /// @param progress   SimulateOptions::progress
  StepCount(double time_step, std::function<bool(const StepProgress&)> progress)
      : time_step_(time_step), progress_(std::move(progress)) {}

  /// Steps done.
  std::int64_t done() const { return done_; }
  void set_done(std::int64_t steps) { done_ = steps; }
  /// Time after a number of steps, which may have a fraction [s].
  double time_of(double steps) const { return steps * time_step_; }
  /// Time after the steps that are done [s].
  double time() const { return time_of(static_cast<double>(done_)); }

  void begin_step() { iterations_ = 0; }
  /// Adds linear iterations of the running step.
  void add_iterations(std::int64_t iterations) { iterations_ += iterations; }
  void end_step() { ++done_; }

  bool has_progress() const { return static_cast<bool>(progress_); }
  /// Calls `progress`.
  /// @param iterations  linear iterations of the running step that are not added yet
  /// @returns false: the step is to end
  bool goes_on(std::int64_t iterations) const {
    return progress_({done_, time(), iterations_ + iterations});
  }

 private:
  double time_step_;
  std::function<bool(const StepProgress&)> progress_;
  std::int64_t done_ = 0;
  std::int64_t iterations_ = 0;  ///< linear iterations of the running step
};

}  // namespace tetwarp

/// @file step_clock.hpp
/// StepClock: when the solves of a step have to end so that it takes no more than its wall time.
#pragma once
#include <algorithm>
#include <limits>

#include "host/base/stopwatch.hpp"

namespace tetwarp {

/// After its solves a step always checks and makes its motion. That is taken to last as long as in
/// the step before.
class StepClock {
 public:
  /// @param most  wall time of a step [s], > 0; infinity: the clock is not asked
  explicit StepClock(double most) : most_(most) {}

  void begin_step() {
    watch_ = {};
    solved_ = 0;
    was_over_ = false;
  }
  /// Whether solves have to end now. Once it is, it stays so until the end of the step.
  bool is_over() {
    was_over_ = was_over_ || !allows(0);
    return was_over_;
  }
  /// Whether solves that take so long would end in time.
  bool allows(double seconds) const {
    return !is_limited() || watch_.seconds() + seconds <= std::max(most_ - rest_, least_ * most_);
  }
  /// Whether is_over() has been true in the step.
  bool was_over() const { return was_over_; }
  /// A solve of the step has ended.
  void end_solve() { solved_ = is_limited() ? watch_.seconds() : 0; }
  void end_step() { rest_ = is_limited() ? watch_.seconds() - solved_ : 0; }

  bool is_limited() const { return most_ < std::numeric_limits<double>::infinity(); }

 private:
  static constexpr double least_ = 0.2;  ///< of the time, which solves always have

  double most_;
  Stopwatch watch_;
  double solved_ = 0;  ///< when the last solve of the step ended [s]
  double rest_ = 0;    ///< of the last step after its solves [s]
  bool was_over_ = false;
};

}  // namespace tetwarp

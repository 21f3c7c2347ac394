/// @file step_clock.hpp
/// StepClock: when the solves of a step have to end so that it takes no more than its wall time.
#pragma once
#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>

#include <tetwarp/simulate.hpp>

#include "host/base/stopwatch.hpp"

namespace tetwarp {

/// After its solves a step always checks and makes its motion. That is taken to last as long as in
/// the step before.
class StepClock {
 public:
  /// @param most  wall time of a step [s], > 0; infinity: the clock is not asked
  explicit StepClock(double most) : most_(most) {}

  /// @param limit  where the following steps end, instead of by the clock; nothing: by the clock
  void follow(const std::optional<StepLimit>& limit) { followed_ = limit; }

  void begin_step() {
    watch_ = {};
    solved_ = 0;
    passed_ = {0, 0};
    limit_ = {};
  }
  /// Whether solves have to end now. Once it is, it stays so until the end of the step.
  bool is_over() {
    count(&StepLimit::checks, 0);
    return was_over();
  }
  /// Whether a division of the step that takes so long would end in time. Once it would not, none
  /// does until the end of the step.
  bool may_divide(double seconds) {
    count(&StepLimit::divisions, seconds);
    return limit_.divisions < 0;
  }
  /// Whether is_over() has been true in the step.
  bool was_over() const { return limit_.checks >= 0; }
  /// Where the step has ended.
  const StepLimit& limit() const { return limit_; }
  /// A solve of the step has ended.
  void end_solve() { solved_ = is_limited() ? watch_.seconds() : 0; }
  void end_step() { rest_ = is_limited() ? watch_.seconds() - solved_ : 0; }

  bool is_limited() const { return most_ < std::numeric_limits<double>::infinity(); }

 private:
  static constexpr double least_ = 0.2;  ///< of the time, which solves always have

  bool has_time(double seconds) const {
    return !is_limited() || watch_.seconds() + seconds <= std::max(most_ - rest_, least_ * most_);
  }
  void count(std::int64_t StepLimit::*of, double seconds) {
    if (limit_.*of >= 0) return;
    const bool ends = followed_ ? passed_.*of == (*followed_).*of : !has_time(seconds);
    if (ends) {
      limit_.*of = passed_.*of;
    } else {
      ++(passed_.*of);
    }
  }

  double most_;
  std::optional<StepLimit> followed_;
  Stopwatch watch_;
  double solved_ = 0;  ///< when the last solve of the step ended [s]
  double rest_ = 0;    ///< of the last step after its solves [s]
  StepLimit passed_;   ///< how often there was time in the step
  StepLimit limit_;    ///< of the step so far
};

}  // namespace tetwarp

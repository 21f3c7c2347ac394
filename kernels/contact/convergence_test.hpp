/// @file contact_monitor.hpp
/// When an island is looked at, when it is done, and which iterate was the best.
#pragma once
#include <cstdint>

#include <tetwarp/choices.hpp>

#include "kernels/contact/contact_residual.hpp"

namespace tetwarp {

/// An island is done when error <= allowed + tolerance * sqrt(r . (u - q)), the last term for eta
/// only. The allowances of all islands together keep the whole problem within the tolerance.
struct StopCriterion {
  ContactMeasure measure = ContactMeasure::eta;
  double tolerance = 0;
  double allowed = 0;

  TETWARP_HD double error_of(const ContactSums& sums) const {
    return sqrt(measure == ContactMeasure::eta ? sums.eta : sums.fclib);
  }
  TETWARP_HD double allowed_at(const ContactSums& sums) const {
    const double work = measure == ContactMeasure::eta ? sqrt(max_of(sums.work, 0.0)) : 0.0;
    return allowed + tolerance * work;
  }
  /// At most 1 when done; never a NaN.
  TETWARP_HD double excess_of(const ContactSums& sums) const {
    const double error = error_of(sums);
    if (error == 0) return 0;
    const double excess = error / max_of(allowed_at(sums), 1e-300);
    return excess < INFINITY ? excess : INFINITY;
  }
};

enum class StopReason {
  converged,
  stalled,   ///< the best residual has not dropped for long
  exhausted  ///< the sweeps are used up
};

/// One measured residual.
struct ContactEvent {
  std::int64_t sweep;
  double error;
};

constexpr std::int64_t endless = INT64_MAX;  ///< sweeps, or patience

/// Follows one island. Measuring costs about a sweep, so it is done when the defect of the
/// iteration (free to know) suggests success, and every now and then.
/// @tparam Log  has note(ContactEvent)
template <class Log>
class ConvergenceTest {
 public:
  /// @param sweeps_done  by those who worked on the island before
  TETWARP_HD ConvergenceTest(const StopCriterion& criterion,
                             std::int64_t sweeps_done,
                             std::int64_t sweep_budget,
                             Log& log)
      : criterion_(criterion),
        log_(log),
        sweep_budget_(sweep_budget),
        sweeps_(sweeps_done),
        measured_sweep_(sweeps_done),
        drop_sweep_(sweeps_done) {}

  TETWARP_HD std::int64_t sweeps() const { return sweeps_; }
  TETWARP_HD double best_excess() const { return best_excess_; }

  /// A new method starts: it may be patient anew.
  TETWARP_HD void start_method(std::int64_t patience) {
    patience_ = patience;
    drop_sweep_ = sweeps_;
    drop_excess_ = best_excess_;
    ratio_ = 0;
  }
  TETWARP_HD void count_sweep() { ++sweeps_; }
  TETWARP_HD bool is_exhausted() const { return sweeps_ >= sweep_budget_; }

  /// Whether to measure now, `defect` being the size of the last change.
  TETWARP_HD bool is_due(double defect) const {
    if (is_exhausted() || ratio_ == 0 || defect * ratio_ <= 1) return true;
    const std::int64_t pause = min_of(max_of(sweeps_ / 8, std::int64_t{4}), std::int64_t{32});
    return sweeps_ - measured_sweep_ >= pause;
  }

  /// Takes a measurement. True: stop.
  /// @param is_best  out: what was measured is the best so far
  TETWARP_HD bool take(const ContactSums& sums, double defect, bool& is_best) {
    const double excess = criterion_.excess_of(sums);
    log_.note({sweeps_, criterion_.error_of(sums)});
    measured_sweep_ = sweeps_;
    ratio_ = defect > 0 ? excess / defect : 0;
    is_best = excess < best_excess_;
    if (is_best) best_excess_ = excess;
    if (best_excess_ < 0.9 * drop_excess_) {
      drop_excess_ = best_excess_;
      drop_sweep_ = sweeps_;
    }
    if (excess <= 1) {
      reason_ = StopReason::converged;
      return true;
    }
    if (sweeps_ - drop_sweep_ >= patience_) {
      reason_ = StopReason::stalled;
      return true;
    }
    reason_ = StopReason::exhausted;
    return is_exhausted();
  }
  TETWARP_HD StopReason reason() const { return reason_; }

 private:
  StopCriterion criterion_;
  Log& log_;
  std::int64_t sweep_budget_;
  std::int64_t sweeps_;
  std::int64_t measured_sweep_;
  std::int64_t drop_sweep_;
  std::int64_t patience_ = endless;
  double best_excess_ = INFINITY;
  double drop_excess_ = INFINITY;
  double ratio_ = 0;  ///< measured excess per defect
  StopReason reason_ = StopReason::exhausted;
};

}  // namespace tetwarp

/// @file convergence_test.hpp
/// When the residual of an island is measured, and when its iteration stops.
#pragma once
#include <cstdint>

#include <tetwarp/choices.hpp>

#include "kernels/contact/contact_residual.hpp"

namespace tetwarp {

/// An island has converged if error <= allowed + tolerance * sqrt(resolved_work()); the last term
/// is for eta only, which must also be resolved: see unresolved_energy(). If all islands have
/// converged, the whole problem is within the tolerance; see stop_criteria().
struct StopCriterion {
  ContactMeasure measure = ContactMeasure::eta;
  double tolerance = 0;
  double allowed = 0;  ///< constant part of the allowed error

  TETWARP_HD double error_of(const ContactSums& sums) const {
    return sqrt(measure == ContactMeasure::eta ? sums.eta : sums.fclib);
  }
  TETWARP_HD double allowed_at(const ContactSums& sums) const {
    const double work = measure == ContactMeasure::eta ? sqrt(resolved_work(sums)) : 0.0;
    return allowed + tolerance * work;
  }
  /// Error over allowed error: at most 1 once converged; infinity instead of NaN.
  TETWARP_HD double excess_of(const ContactSums& sums) const {
    double error = error_of(sums);
    if (measure == ContactMeasure::eta) error = sqrt(sums.eta + unresolved_energy(sums));
    if (error == 0) return 0;
    const double excess = error / max_of(allowed_at(sums), 1e-300);
    return excess < INFINITY ? excess : INFINITY;
  }
};

enum class StopReason {
  converged,
  stalled,   ///< the smallest residual has not dropped; see Patience
  exhausted  ///< all sweeps of the budget are done
};

/// A measured residual and the sweep after which it was measured.
struct ContactEvent {
  std::int64_t sweep;
  double error;
};

constexpr std::int64_t endless = INT64_MAX;  ///< no limit of sweeps, or of patience

/// Sweeps without progress after which a method has stalled: a constant, plus a share of the sweeps
/// during which it made progress. Sweeps whose residual is far above the smallest one count several
/// times: then the acceleration does not fit the problem, whereas a slow one stays near its
/// smallest residual.
struct Patience {
  static constexpr double setback = 1.15;  ///< sweeps whose residual is more than this factor above
                                           ///< the smallest count `setback_weight` times

  std::int64_t sweeps = endless;
  std::int64_t divisor = 0;  ///< of the share; 0: no share
  double drop = 0.9;         ///< of the smallest residual: what is below counts as progress
  std::int64_t setback_weight = 1;

  TETWARP_HD std::int64_t after(std::int64_t progressed) const {
    return divisor > 0 ? sweeps + progressed / divisor : sweeps;
  }
};

/// The convergence test of one island, over all methods that solve it. Measuring a residual costs
/// about as much as a sweep. So is_due() is true only when the defect of the iteration, which costs
/// nothing, suggests convergence, and at growing intervals of 4 to 32 sweeps.
/// @tparam Log  has note(ContactEvent), and stops(), which is called after every sweep: true ends
///              the iteration as if its budget of sweeps were used up
template <class Log>
class ConvergenceTest {
 public:
  /// @param sweeps_done   by earlier solves of the island; included in the budget
  /// @param sweep_budget  largest number of sweeps
  /// @param log           receives every measured residual; kept by the caller
  TETWARP_HD ConvergenceTest(const StopCriterion& criterion,
                             std::int64_t sweeps_done,
                             std::int64_t sweep_budget,
                             Log& log)
      : criterion_(criterion),
        log_(log),
        sweep_budget_(sweep_budget),
        sweeps_(sweeps_done),
        measured_sweep_(sweeps_done),
        drop_sweep_(sweeps_done),
        is_stopped_(log.stops()) {}

  TETWARP_HD std::int64_t sweeps() const { return sweeps_; }
  TETWARP_HD double best_excess() const { return best_excess_; }

  /// Restarts the count of sweeps without progress, for the next method.
  TETWARP_HD void start_method(const Patience& patience) {
    patience_ = patience;
    method_sweep_ = sweeps_;
    waited_ = 0;
    drop_sweep_ = sweeps_;
    drop_excess_ = best_excess_;
    ratio_ = 0;
  }
  TETWARP_HD void count_sweep() {
    ++sweeps_;
    is_stopped_ = log_.stops();
  }
  TETWARP_HD bool is_exhausted() const { return is_stopped_ || sweeps_ >= sweep_budget_; }

  /// Whether to measure the residual now.
  /// @param defect  size of the last change of the impulses
  TETWARP_HD bool is_due(double defect) const {
    if (is_exhausted() || ratio_ == 0 || defect * ratio_ <= 1) return true;
    const std::int64_t pause = min_of(max_of(sweeps_ / 8, std::int64_t{4}), std::int64_t{32});
    return sweeps_ - measured_sweep_ >= pause;
  }

  /// Records a measured residual.
  /// @param defect   as in is_due()
  /// @param is_best  out: it is the smallest so far
  /// @return  whether to stop; reason() returns the cause
  TETWARP_HD bool record(const ContactSums& sums, double defect, bool& is_best) {
    const double excess = criterion_.excess_of(sums);
    log_.note({sweeps_, criterion_.error_of(sums)});
    const std::int64_t elapsed = sweeps_ - measured_sweep_;
    measured_sweep_ = sweeps_;
    ratio_ = defect > 0 ? excess / defect : 0;
    is_best = excess < best_excess_;
    if (is_best) best_excess_ = excess;
    if (best_excess_ < patience_.drop * drop_excess_) {
      drop_excess_ = best_excess_;
      drop_sweep_ = sweeps_;
      waited_ = 0;
    } else {
      const bool is_setback = excess > Patience::setback * best_excess_;
      waited_ += elapsed * (is_setback ? patience_.setback_weight : 1);
    }
    if (excess <= 1) {
      reason_ = StopReason::converged;
      return true;
    }
    if (waited_ >= patience_.after(drop_sweep_ - method_sweep_)) {
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
  bool is_stopped_;
  std::int64_t method_sweep_ = 0;  ///< at which the current method started
  std::int64_t waited_ = 0;        ///< sweeps without progress, weighted
  Patience patience_;
  double best_excess_ = INFINITY;
  double drop_excess_ = INFINITY;
  double ratio_ = 0;  ///< excess per defect at the last measurement; 0: none yet
  StopReason reason_ = StopReason::exhausted;
};

}  // namespace tetwarp

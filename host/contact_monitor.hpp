/// @file contact_monitor.hpp
/// When an island is looked at, when it is done, and which iterate was the best.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <tetwarp/contact.hpp>

#include "kernels/contact_residual.hpp"

namespace tetwarp {

/// An island is done when error <= allowed + tolerance * sqrt(r . (u - q)), the last term for eta
/// only. The allowances of all islands together keep the whole problem within the tolerance.
struct StopRule {
  ContactMeasure measure = ContactMeasure::eta;
  double tolerance = 0;
  double allowed = 0;

  double error_of(const ContactSums& sums) const {
    return std::sqrt(measure == ContactMeasure::eta ? sums.eta : sums.fclib);
  }
  double allowed_at(const ContactSums& sums) const {
    const double work = measure == ContactMeasure::eta ? std::sqrt(std::max(sums.work, 0.0)) : 0.0;
    return allowed + tolerance * work;
  }
  /// At most 1 when done.
  double excess_of(const ContactSums& sums) const {
    const double error = error_of(sums);
    if (error == 0) return 0;
    const double excess = error / std::max(allowed_at(sums), 1e-300);
    return std::isfinite(excess) ? excess : std::numeric_limits<double>::infinity();
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

/// Follows one island. Measuring costs about a sweep, so it is done when the defect of the
/// iteration (free to know) suggests success, and every now and then.
template <class T>
class ContactMonitor {
 public:
  /// @param sweeps_done  by those who worked on the island before
  ContactMonitor(const StopRule& rule, std::int64_t sweeps_done, std::int64_t sweep_budget)
      : rule_(rule),
        sweep_budget_(sweep_budget),
        sweeps_(sweeps_done),
        measured_sweep_(sweeps_done),
        drop_sweep_(sweeps_done) {}

  std::int64_t sweeps() const { return sweeps_; }
  double best_excess() const { return best_excess_; }
  const std::vector<ContactEvent>& events() const { return events_; }

  /// A new method starts: it may be patient anew.
  void start_method(std::int64_t patience) {
    patience_ = patience;
    drop_sweep_ = sweeps_;
    drop_excess_ = best_excess_;
    ratio_ = 0;
  }
  void count_sweep() { ++sweeps_; }
  bool is_exhausted() const { return sweeps_ >= sweep_budget_; }

  /// Whether to measure now, `defect` being the size of the last change.
  bool is_due(double defect) const {
    if (is_exhausted() || ratio_ == 0 || defect * ratio_ <= 1) return true;
    return sweeps_ - measured_sweep_ >= std::clamp<std::int64_t>(sweeps_ / 8, 4, 32);
  }

  /// Takes a measurement of the state that `keep` can save. True: stop.
  template <class Keep>
  bool take(const ContactSums& sums, double defect, const Keep& keep) {
    const double excess = rule_.excess_of(sums);
    events_.push_back({sweeps_, rule_.error_of(sums)});
    measured_sweep_ = sweeps_;
    ratio_ = defect > 0 ? excess / defect : 0;
    if (excess < best_excess_) {
      best_excess_ = excess;
      keep();
    }
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
  StopReason reason() const { return reason_; }

 private:
  StopRule rule_;
  std::int64_t sweep_budget_;
  std::int64_t sweeps_;
  std::int64_t measured_sweep_;
  std::int64_t drop_sweep_;
  std::int64_t patience_ = std::numeric_limits<std::int64_t>::max();
  double best_excess_ = std::numeric_limits<double>::infinity();
  double drop_excess_ = std::numeric_limits<double>::infinity();
  double ratio_ = 0;  ///< measured excess per defect
  StopReason reason_ = StopReason::exhausted;
  std::vector<ContactEvent> events_;
};

}  // namespace tetwarp

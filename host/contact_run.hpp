/// @file contact_run.hpp
/// All islands whose blocks A does not couple, in one scalar type.
#pragma once
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact_exec_cpu.hpp"
#include "host/contact_methods.hpp"
#include "host/contact_monitor.hpp"
#include "host/contact_pipeline.hpp"

namespace tetwarp {

/// How an island ended.
struct IslandOutcome {
  StopReason reason = StopReason::converged;
  std::int64_t sweeps = 0;
  std::int64_t outer_iterations = 0;
  std::int64_t newton_iterations = 0;
  std::int64_t contact_updates = 0;
  std::vector<const char*> methods;  ///< in order
  std::vector<ContactEvent> events;
  ContactSums sums;        ///< of what is returned
  ContactSums free;        ///< of no impulses at all
  double free_square = 0;  ///< |q|^2
};

inline ContactSwitches switches_of(const ContactOptions& options) {
  return {options.law == FrictionLaw::pyramid, options.rule == AdhesionRule::restrictive};
}

template <class T>
class ContactRun {
 public:
  ContactRun(const ContactOptions& options,
             int threads,
             const ContactStructure& structure,
             const ContactSystem<T>& system,
             std::vector<IslandOutcome>& outcomes)
      : options_(options),
        threads_(threads),
        structure_(structure),
        system_(system),
        outcomes_(outcomes) {
    state_.impulse.assign(system.free_velocity.size(), T(0));
    state_.velocity = system.free_velocity;
    state_.body_velocity = system.body_free;
    if (options.method == ContactMethod::gauss_seidel && options.skip.frozen_contacts) {
      state_.calm.assign(system.constants.size(), 0);
      state_.left_out.assign(system.constants.size(), 0);
    }
    find_rules();
  }

  ContactState<T>& state() { return state_; }
  const ContactSystem<T>& system() const { return system_; }
  std::int64_t updates_skipped() const {
    std::int64_t sum = 0;
    for (const std::int32_t visits : state_.left_out) sum += visits;
    return sum;
  }

  /// @param impulse  [3 slots], or empty: none
  void start_from(const std::vector<T>& impulse) {
    if (!impulse.empty()) state_.impulse = impulse;
  }

  /// Islands side by side; only the contacts of large ones are shared among threads.
  void solve() {
    std::vector<std::int64_t> small;
    for (std::int64_t i = 0; i < structure_.contact_islands; ++i) {
      if (island(i).is_coupled) continue;
      if (threads_ > 1 && island(i).contact_count() >= shared_from) {
        solve_island(i, threads_);
      } else {
        small.push_back(i);
      }
    }
    const bool is_worth_it = threads_ > 1 && small.size() > 1 && system_.constants.size() > 128;
#pragma omp parallel for schedule(dynamic) num_threads(threads_) if (is_worth_it)
    for (std::size_t k = 0; k < small.size(); ++k) solve_island(small[k], 1);
  }

  /// More sweeps on one island, to the end of the budget.
  void insist(std::int64_t i) {
    continue_island(i, threads_, [&](ContactMethods<CpuContactExec, T>& methods) {
      methods.conjugate_directions(std::numeric_limits<std::int64_t>::max());
    });
  }

  /// Sums of an island, of the impulses at hand.
  ContactSums measure(std::int64_t i) {
    CpuContactExec exec(1);
    ContactPipeline<CpuContactExec, T> pipeline = pipeline_of(i, exec);
    pipeline.follow_impulses();
    return pipeline.measure();
  }
  /// The error of an island over what it may leave.
  double excess(std::int64_t i, const ContactSums& sums) const {
    return rules_[static_cast<std::size_t>(i)].excess_of(sums);
  }
  bool is_done(std::int64_t i, const ContactSums& sums) const {
    return excess(i, sums) <= 1;
  }
  const std::vector<StopRule>& rules() const {
    return rules_;
  }

 private:
  /// Contacts of an island worth all threads. Waking them in the middle of a sweep costs as much as
  /// some thousand contacts do, and colors hold only a part of all.
  static constexpr std::int64_t shared_from = 16384;
  static constexpr std::int64_t patience = 100;  ///< sweeps without a drop before a fallback

  const ContactIsland& island(std::int64_t i) const {
    return structure_.islands[static_cast<std::size_t>(i)];
  }
  ContactPipeline<CpuContactExec, T> pipeline_of(std::int64_t i, CpuContactExec& exec) {
    return {exec, structure_, system_, island(i), switches_of(options_), state_};
  }

  /// What each island may leave over: half by its share in the error without impulses, half by its
  /// number of contacts, so that none has to be solved to nothing.
  void find_rules() {
    CpuContactExec exec(1);
    std::vector<double> squares;
    double total = 0;
    std::int64_t contacts = 0;
    for (std::int64_t i = 0; i < structure_.contact_islands; ++i) {
      squares.push_back(0);
      if (island(i).is_coupled) continue;
      IslandOutcome& outcome = outcomes_[static_cast<std::size_t>(i)];
      outcome.free = pipeline_of(i, exec).measure();
      outcome.free_square = 0;
      for (std::int64_t k = 3 * island(i).slot_begin; k < 3 * island(i).slot_end; ++k) {
        outcome.free_square +=
            square_of(double{system_.free_velocity[static_cast<std::size_t>(k)]});
      }
      squares.back() =
          options_.measure == ContactMeasure::eta ? outcome.free.eta : outcome.free_square;
      total += squares.back();
      contacts += island(i).contact_count();
    }
    for (std::int64_t i = 0; i < structure_.contact_islands; ++i) {
      const double share =
          static_cast<double>(island(i).contact_count()) / static_cast<double>(contacts);
      const double square = (squares[static_cast<std::size_t>(i)] + total * share) / 2;
      rules_.push_back(
          {options_.measure, options_.tolerance, options_.tolerance * std::sqrt(square)});
    }
  }

  void solve_island(std::int64_t i, int threads) {
    continue_island(i, threads, [&](ContactMethods<CpuContactExec, T>& methods) {
      run_methods(methods, outcomes_[static_cast<std::size_t>(i)]);
    });
  }

  template <class Run>
  void continue_island(std::int64_t i, int threads, const Run& run) {
    CpuContactExec exec(threads);
    ContactPipeline<CpuContactExec, T> pipeline = pipeline_of(i, exec);
    IslandOutcome& outcome = outcomes_[static_cast<std::size_t>(i)];
    ContactMonitor<T> monitor(rules_[static_cast<std::size_t>(i)], outcome.sweeps,
                              options_.max_sweeps);
    ContactMethods<CpuContactExec, T> methods(pipeline, monitor);
    if (!methods.is_done_at_start()) {
      run(methods);
      methods.restore_best();
    }
    outcome.reason = monitor.reason();
    outcome.sweeps = monitor.sweeps();
    outcome.contact_updates = monitor.sweeps() * pipeline.island().contact_count();
    outcome.events.insert(outcome.events.end(), monitor.events().begin(), monitor.events().end());
  }

  void run_methods(ContactMethods<CpuContactExec, T>& methods, IslandOutcome& outcome) {
    constexpr std::int64_t forever = std::numeric_limits<std::int64_t>::max();
    switch (options_.method) {
      case ContactMethod::gauss_seidel:
        outcome.methods = {"gauss_seidel"};
        methods.gauss_seidel(forever, {view_of(state_.calm), view_of(state_.left_out), true,
                                       static_cast<T>(options_.tolerance / 100)});
        return;
      case ContactMethod::nonlinear_cg:
        outcome.methods = {"nonlinear_cg"};
        methods.conjugate_directions(forever);
        return;
      case ContactMethod::anderson:
        outcome.methods = {"anderson"};
        methods.anderson(forever);
        return;
      case ContactMethod::mass_splitting:
        outcome.methods = {"mass_splitting"};
        methods.mass_splitting(forever);
        return;
      case ContactMethod::automatic:
      case ContactMethod::newton:
        break;
    }
    outcome.methods = {"anderson"};
    if (methods.anderson(patience) != StopReason::stalled) return;
    methods.restore_best();
    outcome.methods.push_back("nonlinear_cg");
    methods.conjugate_directions(2 * patience);
  }

  const ContactOptions& options_;
  int threads_;
  const ContactStructure& structure_;
  const ContactSystem<T>& system_;
  ContactState<T> state_;
  std::vector<StopRule> rules_;
  std::vector<IslandOutcome>& outcomes_;
};

}  // namespace tetwarp

/// @file run.hpp
/// Solves all islands whose blocks A does not couple, in one precision, on the host.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/base/parallel.hpp"
#include "host/contact/problem/budget.hpp"
#include "host/contact/structure/system.hpp"
#include "host/exec/exec_cpu.hpp"
#include "kernels/contact/contact_memory.hpp"
#include "kernels/contact/contact_methods.hpp"

namespace tetwarp {

/// Result and cost of one island.
struct IslandOutcome {
  StopReason reason = StopReason::converged;
  std::int64_t sweeps = 0;
  std::int64_t outer_iterations = 0;
  std::int64_t multiplier_steps = 0;
  std::int64_t newton_iterations = 0;
  std::int64_t contact_updates = 0;
  std::vector<const char*> methods;  ///< names, in the order of use
  std::vector<ContactEvent> events;  ///< measured residuals
  ContactSums sums;                  ///< of the solution
  ContactSums free;                  ///< of zero impulses
  double free_square = 0;            ///< |q|^2

  /// Adds the result of solve_island().
  /// @param contacts  of the island
  void add(const IslandEnd& end, ContactMethod method, std::int64_t contacts);
};

struct HostEventLog {
  std::vector<ContactEvent> events;
  SolveBudget* budget = nullptr;  ///< ends the iteration; null: no limits

  void note(const ContactEvent& event) { events.push_back(event); }
  bool stops() const { return budget != nullptr && budget->count_sweep(); }
};

inline ContactSwitches switches_of(const ContactOptions& options) {
  return {options.law == FrictionLaw::pyramid, options.rule == AdhesionRule::restrictive};
}

inline MethodPlan plan_of(const ContactOptions& options) {
  return {options.method, options.tolerance / 100, options.max_sweeps};
}

inline bool freezes_contacts(const ContactOptions& options) {
  return options.method == ContactMethod::gauss_seidel && options.expert.skip.frozen_contacts;
}

/// The stop criterion of each island. Half of the allowed error of the whole problem is distributed
/// by the error of zero impulses, half by the number of contacts, so that every island has a
/// positive limit.
/// @param outcomes  `free` and `free_square` of uncoupled islands are read
/// @return  [islands with contacts]; of coupled ones not used
std::vector<StopCriterion> stop_criteria(const ContactOptions& options,
                                         const ContactStructure& structure,
                                         const std::vector<IslandOutcome>& outcomes);

/// Solves the uncoupled islands of one problem.
template <class T>
class ContactRun {
 public:
  /// Measures the islands without impulses. Arguments are kept by the caller.
  /// @param outcomes  [islands with contacts]; results are added
  /// @param budget    null: no limits besides those of the sweeps
  ContactRun(const ContactOptions& options,
             int threads,
             const ContactStructure& structure,
             const ContactSystem<T>& system,
             std::vector<IslandOutcome>& outcomes,
             SolveBudget* budget = nullptr)
      : options_(options),
        threads_(threads),
        structure_(structure),
        system_(system),
        numbers_(system.numbers(structure.indices())),
        work_(work_memory_.reserve(static_cast<std::int64_t>(system.constants.size()))),
        outcomes_(outcomes),
        budget_(budget) {
    CpuExec exec(1, StageClocks::off);
    state_.reset(exec, numbers_, freezes_contacts(options));
    for (std::int64_t i = 0; i < structure.contact_islands; ++i) {
      if (!island(i).is_coupled) measure_free(i);
    }
    criteria_ = stop_criteria(options, structure, outcomes);
  }

  StateMemory<CpuExec, T>& state() { return state_; }
  const ContactSystem<T>& system() const { return system_; }
  /// Visits of frozen contacts that sweeps skipped.
  std::int64_t updates_skipped() const {
    std::int64_t sum = 0;
    for (const std::int32_t visits : state_.skipped_visits) sum += visits;
    return sum;
  }

  /// Sets the current impulses.
  /// @param impulse  [3 slots]; empty: no change
  void start_from(const std::vector<T>& impulse) {
    if (!impulse.empty()) state_.impulse = impulse;
  }

  /// Solves all islands: large ones one after the other by all threads, the others in parallel by
  /// one thread each.
  /// @param most_sweeps  (island) sweeps at most; options.max_sweeps at most
  template <class MostSweeps>
  void solve(const MostSweeps& most_sweeps) {
    std::vector<std::int64_t> small;
    std::int64_t contacts = 0, most = 0;  // of small islands: of all, of the largest
    for (std::int64_t i = 0; i < structure_.contact_islands; ++i) {
      if (island(i).is_coupled) continue;
      const std::int64_t own = island(i).contact_count();
      if (threads_ > 1 && own >= shared_from) {
        go_on(i, threads_, options_.method, std::min(most_sweeps(i), options_.max_sweeps));
      } else {
        small.push_back(i);
        contacts += own;
        most = std::max(most, own);
      }
    }
    const bool is_worth_it = contacts - most >= worth_a_thread;
    parallel_tasks(is_worth_it ? threads_ : 1, std::ssize(small), [&](std::int64_t k) {
      const std::int64_t i = small[static_cast<std::size_t>(k)];
      go_on(i, 1, options_.method, std::min(most_sweeps(i), options_.max_sweeps));
    });
  }

  /// Continues one island by a method of sweeps until it converges or has had `sweep_end` sweeps in
  /// all; options.max_sweeps at most. Leaves the last impulses; best_impulse() has the best.
  /// @return  error over allowed error of the best impulses
  double sweep_past_best(std::int64_t i, std::int64_t sweep_end, ContactMethod method) {
    return go_on(i, threads_of(i), method, std::min(sweep_end, options_.max_sweeps), false);
  }
  /// [3 slots of the island], of the last sweeps of the island
  const T* best_impulse(std::int64_t i) const { return work_.best.data + 3 * island(i).slot_begin; }

  ContactSums measure(std::int64_t i) {
    CpuExec exec(1, StageClocks::off);
    return measure_island(pipeline_of(i, exec)).sums;
  }
  /// Error over allowed error of an island.
  double excess(std::int64_t i, const ContactSums& sums) const {
    return criteria_[static_cast<std::size_t>(i)].excess_of(sums);
  }
  bool is_done(std::int64_t i, const ContactSums& sums) const { return excess(i, sums) <= 1; }
  const std::vector<StopCriterion>& criteria() const { return criteria_; }

 private:
  /// Number of contacts from which an island uses all threads. Starting threads for one color costs
  /// as much as some thousand contacts, and a color has only a part of all contacts.
  static constexpr std::int64_t shared_from = 16384;
  /// Contacts outside the largest small island from which islands are solved in parallel: with
  /// fewer, solves take less than the start of a thread costs.
  static constexpr std::int64_t worth_a_thread = 512;

  int threads_of(std::int64_t i) const {
    return island(i).contact_count() >= shared_from ? threads_ : 1;
  }
  const ContactIsland& island(std::int64_t i) const {
    return structure_.islands[static_cast<std::size_t>(i)];
  }
  ContactPipeline<CpuExec, T> pipeline_of(std::int64_t i, CpuExec& exec) {
    return {
        exec,          numbers_, view_of(structure_.color_start), island(i), switches_of(options_),
        state_.views()};
  }

  void measure_free(std::int64_t i) {
    CpuExec exec(1, StageClocks::off);
    IslandOutcome& outcome = outcomes_[static_cast<std::size_t>(i)];
    const IslandSums sums = measure_island(pipeline_of(i, exec));
    outcome.free = sums.sums;
    outcome.free_square = sums.free_square;
  }

  double go_on(std::int64_t i,
               int threads,
               ContactMethod method,
               std::int64_t sweep_end,
               bool leaves_best = true) {
    CpuExec exec(threads, StageClocks::off);
    ContactPipeline<CpuExec, T> pipeline = pipeline_of(i, exec);
    IslandOutcome& outcome = outcomes_[static_cast<std::size_t>(i)];
    HostEventLog log{.events = {}, .budget = budget_};
    MethodPlan plan = plan_of(options_);
    plan.method = method;
    plan.sweep_budget = sweep_end;
    plan.leaves_best = leaves_best;
    const IslandEnd end = solve_island(pipeline, criteria_[static_cast<std::size_t>(i)], plan,
                                       outcome.sweeps, work_, log);
    outcome.add(end, method, island(i).contact_count());
    outcome.events.insert(outcome.events.end(), log.events.begin(), log.events.end());
    return end.best_excess;
  }

  const ContactOptions& options_;
  int threads_;
  const ContactStructure& structure_;
  const ContactSystem<T>& system_;
  ContactNumbers<T> numbers_;
  StateMemory<CpuExec, T> state_;
  MethodMemory<CpuExec, T> work_memory_;
  MethodWork<T> work_;
  std::vector<StopCriterion> criteria_;
  std::vector<IslandOutcome>& outcomes_;
  SolveBudget* budget_;
};

}  // namespace tetwarp

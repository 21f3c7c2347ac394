/// @file island_attempt.hpp
/// An island that its first sweeps have not solved: its impulses, and how far they are from a
/// solution.
#pragma once
#include <cstdint>
#include <optional>
#include <utility>

#include <tetwarp/contact.hpp>

#include "host/contact/newton/newton.hpp"
#include "host/contact/problem/budget.hpp"
#include "host/contact/structure/structure.hpp"
#include "host/contact/sweeps/run.hpp"

namespace tetwarp {

/// A problem that is solved on the host. The caller keeps all parts.
struct HostProblem {
  const ContactOptions& options;
  const ContactStructure& structure;
  const ContactProblem& problem;
  SolveBudget* budget;  ///< null: no limits
};

/// The current impulses are those of a ContactRun; outcome().sums are those of the last measure().
class IslandAttempt {
 public:
  /// @param run, outcome  kept by the caller
  IslandAttempt(const HostProblem& all,
                std::int64_t island,
                ContactRun<double>& run,
                IslandOutcome& outcome)
      : all_(all), index_(island), run_(run), outcome_(outcome) {}

  const HostProblem& all() const { return all_; }
  const ContactOptions& options() const { return all_.options; }
  const ContactStructure& structure() const { return all_.structure; }
  const ContactProblem& problem() const { return all_.problem; }
  SolveBudget* budget() const { return all_.budget; }
  ContactRun<double>& run() { return run_; }
  IslandOutcome& outcome() { return outcome_; }
  /// Its number in the structure.
  std::int64_t index() const { return index_; }
  const ContactIsland& island() const { return all_.structure.islands[index_of(index_)]; }
  /// The island as a problem of its own; made at the first call.
  const ContactProblem& part();

  /// The current impulses [N s], [3 contacts].
  double* impulse() { return run_.state().impulse.data() + 3 * island().slot_begin; }
  std::int64_t size() const { return 3 * island().contact_count(); }

  /// Sweeps that are allowed, of outcome().sweeps.
  std::int64_t max_sweeps() const { return all_.options.max_sweeps - abandoned_; }
  /// Counts the sweeps so far apart from outcome().sweeps, by which methods are chosen, until
  /// add_abandoned().
  void abandon_sweeps() { abandoned_ += std::exchange(outcome_.sweeps, 0); }
  void add_abandoned() { outcome_.sweeps += std::exchange(abandoned_, 0); }

  bool is_over() const { return all_.budget != nullptr && all_.budget->is_over(); }
  void measure() { outcome_.sums = run_.measure(index_); }
  /// Error over allowed error, of the last measure().
  double excess() const { return run_.excess(index_, outcome_.sums); }
  bool is_done() const { return run_.is_done(index_, outcome_.sums); }

  /// Newton's method from the current impulses; keeps its impulses unless their error is larger.
  /// Does nothing where there is rolling friction, which it does not have.
  void polish(const NewtonLimits& limits);
  /// The method of multipliers from the current impulses, as polish().
  void solve_by_multipliers();
  /// Sweeps that take as long as a step of Newton's method; infinity where it is not used.
  double sweeps_per_newton_step();

 private:
  template <class Method>
  void improve(const char* name, std::int64_t& steps, const Method& method);

  HostProblem all_;
  std::int64_t index_;
  ContactRun<double>& run_;
  IslandOutcome& outcome_;
  std::optional<ContactProblem> part_;
  std::int64_t abandoned_ = 0;
};

}  // namespace tetwarp

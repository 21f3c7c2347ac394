/// @file island_attempt.cpp
/// Newton's method and the method of multipliers on one island, and the cost of the former.
#include "host/contact/solve/island_attempt.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "host/contact/newton/augmented_lagrangian.hpp"
#include "host/contact/newton/newton_system.hpp"
#include "host/contact/problem/row_blocks.hpp"
#include "host/contact/solve/method_choice.hpp"
#include "host/contact/structure/extract.hpp"
#include "host/contact/sweeps/method_names.hpp"

namespace tetwarp {

const ContactProblem& IslandAttempt::part() {
  if (!part_) part_ = make_island_problem(all_.problem, all_.structure, island());
  return *part_;
}

/// Replaces the current impulses by those of a method, unless their error is larger.
/// @param steps   the count of its factorizations
/// @param method  (options, impulses in and out) -> NewtonResult
template <class Method>
void IslandAttempt::improve(const char* name, std::int64_t& steps, const Method& method) {
  ContactOptions options = all_.options;
  options.tolerance /= 2;  // relative to this island, not to the whole problem
  double* const current = impulse();
  std::vector<double> improved(current, current + size());
  const std::vector<double> swept = improved;
  const NewtonResult newton = method(options, improved);
  steps += newton.iterations;
  if (newton.iterations > 0) outcome_.methods.push_back(name);
  const double before = excess();
  std::ranges::copy(improved, current);
  measure();
  if (!(excess() > before)) return;
  std::ranges::copy(swept, current);
  measure();
}

void IslandAttempt::polish(const NewtonLimits& limits) {
  if (has_rolling(part())) return;
  improve(report_name_of(ContactMethod::newton), outcome_.newton_iterations,
          [&](const ContactOptions& options, std::vector<double>& impulse) {
            std::vector<double> body_velocity;
            return newton_polish(part(), options, impulse, body_velocity, all_.budget, limits);
          });
}

void IslandAttempt::solve_by_multipliers() {
  improve("multipliers", outcome_.multiplier_steps,
          [&](const ContactOptions& options, std::vector<double>& impulse) {
            return tetwarp::solve_by_multipliers(part(), options, run_.criteria()[index_of(index_)],
                                                 impulse, all_.budget);
          });
}

double IslandAttempt::sweeps_per_newton_step() {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const double memory = all_.budget != nullptr ? all_.budget->memory_limit() : infinity;
  const NewtonCost cost = newton_cost(part(), memory);
  const bool is_left_out = all_.options.max_newton == 0 || has_rolling(part());
  if (is_left_out || cost.bytes > memory) return infinity;
  return tetwarp::sweeps_per_newton_step(cost, part().contact_count());
}

}  // namespace tetwarp

/// @file island_attempt.cpp
/// Newton's method on one island, and its cost.
#include "host/contact/solve/island_attempt.hpp"

#include <algorithm>
#include <limits>
#include <vector>

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

void IslandAttempt::polish(const NewtonLimits& limits) {
  if (has_rolling(part())) return;
  ContactOptions options = all_.options;
  options.tolerance /= 2;  // relative to this island, not to the whole problem
  double* const current = impulse();
  std::vector<double> polished(current, current + size()), body_velocity;
  const std::vector<double> swept = polished;
  const NewtonResult newton =
      newton_polish(part(), options, polished, body_velocity, all_.budget, limits);
  outcome_.newton_iterations += newton.iterations;
  if (newton.iterations > 0) outcome_.methods.push_back(report_name_of(ContactMethod::newton));
  const double before = excess();
  std::copy(polished.begin(), polished.end(), current);
  measure();
  if (!(excess() > before)) return;
  std::copy(swept.begin(), swept.end(), current);
  measure();
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

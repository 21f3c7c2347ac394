/// @file method_choice.cpp
/// The cost of a Newton step in sweeps, and when it is worth it.
#include "host/contact/solve/method_choice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tetwarp {

double sweeps_per_newton_step(const NewtonCost& cost, std::int64_t contacts) {
  // Measured on stacks of 40, jams of 150 and packings of 224 to 1664 contacts: a Newton step takes
  // as long as so many updates of a contact by sweeps.
  constexpr double updates_per_flop = 0.012;
  constexpr double updates_per_contact = 20;
  return updates_per_contact +
         updates_per_flop * cost.flops / static_cast<double>(std::max<std::int64_t>(contacts, 1));
}

double sweeps_left(double before, double after, std::int64_t sweeps) {
  if (!(after < before) || !std::isfinite(before)) return std::numeric_limits<double>::infinity();
  return static_cast<double>(sweeps) * std::log(2 * after) / std::log(before / after);
}

double newton_worth(double sweeps_per_step) {
  constexpr double usual = 30;
  const double fill = std::max(sweeps_per_step / usual, 1.0);
  return sweeps_per_step * fill * fill;
}

bool prefers_newton(double worth, std::int64_t spent, double left) {
  const auto so_far = static_cast<double>(spent);
  return left > worth && worth <= 0.4 * (so_far + std::min(left, 10 * so_far));
}

void SweepChoice::note(std::int64_t spent, double left) {
  slow_ = left > 8 * static_cast<double>(spent) ? slow_ + 1 : 0;
  if (slow_ < 3 || left < other_left_) return;
  slow_ = 0;
  other_left_ = left;
  current_ =
      current_ == ContactMethod::anderson ? ContactMethod::nonlinear_cg : ContactMethod::anderson;
}

}  // namespace tetwarp

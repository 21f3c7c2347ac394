/// @file step_division.cpp
/// Into how many parts the next attempt divides a step.
#include "host/simulate/state/step_division.hpp"

#include <utility>

#include "host/simulate/step/scene_record.hpp"

namespace tetwarp {
namespace {

constexpr double largest_turn = 0.5;    // of a rigid body in a part [rad]
constexpr double held_fraction = 0.05;  // of a step: bodies that move less are held up
constexpr int most_held_steps = 2;      // successive ones, before a step is divided
// After a step that was not good in the smallest parts either, this many steps are not divided
// because of contact: bodies that are squeezed may stay so for long.
constexpr int steps_without_parts = 8;

}  // namespace

int StepDivision::first_parts(double spin) const {
  int parts = 1;
  while (can_double(parts) && spin * (scene_.scene.time_step / parts) > largest_turn) parts *= 2;
  return parts;
}

bool StepDivision::can_double(int parts) const {
  return 2 * parts <= scene_.scene.solver.max_substeps;
}

bool StepDivision::is_good(const StepAttempt& attempt,
                           const ContactPart& contact,
                           double time_step,
                           HostState& state) {
  const std::int64_t counted = std::exchange(inverted_, -1);
  if (!attempt.is_finite || !attempt.outcome.converged) return false;
  if (state.largest_spin() * time_step > largest_turn) return false;
  if (now_.undivided_steps > 0) return true;
  if (!attempt.contact.converged) return false;
  if (contact.smallest_fraction < held_fraction && now_.held_steps >= most_held_steps) return false;
  if (contact.contacts == 0) return true;
  const std::int64_t before =
      counted >= 0 ? counted : inverted_count(scene_.model, state.before_part());
  inverted_ = inverted_count(scene_.model, state.get());
  return inverted_ <= before;
}

void StepDivision::accept(const StepAttempt& made) {
  const bool is_held = made.contact.smallest_fraction < held_fraction;
  now_.held_steps = is_held ? now_.held_steps + 1 : 0;
  if (!made.is_good) {
    now_.undivided_steps = steps_without_parts;
  } else if (now_.undivided_steps > 0) {
    --now_.undivided_steps;
  }
}

void StepDivision::set_state(const DivisionState& state) {
  now_ = state;
  forget_counts();
}

}  // namespace tetwarp

/// @file body_sleep.cpp
/// Falls asleep and wakes at the start and the end of a step.
#include "host/simulate/run/body_sleep.hpp"

namespace tetwarp {

BodySleep::BodySleep(const SimulatedScene& scene,
                     ContactStep* contact,
                     BodyStepper& stepper,
                     HostState& state)
    : time_step_(scene.scene.time_step),
      contact_(contact),
      stepper_(stepper),
      bodies_(state),
      sleep_(scene.scene, scene.geometry, scene.model) {}

/// Bodies of contacts that sleep.
std::span<const BodyLink> BodySleep::links() const {
  if (contact_ == nullptr) return {};
  return contact_->sleeping_links();
}

void BodySleep::begin_part(StepInput& input) {
  if (!sleep_.is_on()) return;
  const bool has_woken = sleep_.begin(bodies_.get(), links(), input);
  if (contact_ == nullptr) return;
  if (has_woken) {
    contact_->thaw(sleep_.still());
  } else {
    contact_->set_still(sleep_.still());
  }
}

void BodySleep::wake(std::span<const std::int32_t> bodies, StepInput& input) {
  sleep_.wake(bodies, links(), input);
  contact_->thaw(sleep_.still());
  stepper_.set_velocities(bodies_.get().velocity);
}

void BodySleep::end_step(bool may_sleep, const StepInput& input) {
  static const ContactRest no_contacts;
  if (!sleep_.is_on()) return;
  if (!may_sleep) return sleep_.interrupt();
  const ContactRest& rest = contact_ != nullptr ? contact_->rest() : no_contacts;
  ModelState& state = bodies_.velocities_to_change();
  if (!sleep_.end(input, rest, time_step_, state)) return;
  stepper_.set_state(state);
  if (contact_ != nullptr) contact_->freeze(sleep_.still());
}

}  // namespace tetwarp

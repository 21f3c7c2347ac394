// Bodies at rest: when a Simulator lets them sleep and wakes them.
#include "host/simulate/run/simulator_impl.hpp"

namespace tetwarp {

const std::vector<BodyLink>& Simulator::Impl::sleeping_links() const {
  static const std::vector<BodyLink> none;
  return contact_ ? contact_->sleeping_links() : none;
}

/// Before the solve of a part, whose input is filled.
void Simulator::Impl::begin_sleep() {
  const bool has_woken = sleep_.begin(state_, sleeping_links(), input_);
  if (!contact_) return;
  if (has_woken) {
    contact_->thaw(sleep_.still());
  } else {
    contact_->set_still(sleep_.still());
  }
}

/// Within a part, before anything has moved.
void Simulator::Impl::wake(std::span<const std::int32_t> bodies) {
  sleep_.wake(bodies, sleeping_links(), input_);
  contact_->thaw(sleep_.still());
  stepper->set_velocities(state_.velocity);
}

void Simulator::Impl::fall_asleep(const Attempt& made) {
  static const ContactRest no_contacts;
  const bool grows =
      !growth_.empty() && time_of(static_cast<double>(step_index)) < RestGrowth::duration;
  if (!made.is_good || grows) {
    sleep_.interrupt();
  } else if (sleep_.end(input_, contact_ ? contact_->rest() : no_contacts, scene.time_step,
                        state_)) {
    stepper->set_state(state_);
    if (contact_) contact_->freeze(sleep_.still());
  }
  sleeping_ = sleep_.group_count(sleeping_links());
}

}  // namespace tetwarp

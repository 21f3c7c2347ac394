/// @file simulator_state.cpp
/// Where the state of a Simulator is: in memory of the host, or of a device until somebody reads
/// it.
#include <algorithm>

#include "host/base/point3.hpp"
#include "host/simulate/run/simulator_impl.hpp"
#include "host/simulate/step/scene_record.hpp"

namespace tetwarp {
namespace {
constexpr double largest_turn = 0.5;  // of a rigid body in a step [rad]
}  // namespace

const ModelState& Simulator::Impl::state() const {
  if (!is_state_here_) stepper->get_state(state_);
  is_state_here_ = true;
  return state_;
}

double Simulator::Impl::largest_spin() const {
  double largest = 0;
  for (std::int32_t r = 0; r < model.rigid_count; ++r) {
    if (model.rigid.mass[static_cast<std::size_t>(r)] == 0) continue;
    largest = std::max(largest, norm(angular_velocity_of(model, state_, r)));
  }
  return largest;
}

bool Simulator::Impl::turns_too_far(double time_step) const {
  return largest_spin_ * time_step > largest_turn;
}

void Simulator::Impl::set_state(const ModelState& next) {
  state_ = next;
  is_state_here_ = true;
  largest_spin_ = largest_spin();
  stepper->set_state(state_);
}

/// Before a step.
void Simulator::Impl::keep_state() {
  kept_spin_ = largest_spin_;
  if (resident_ != nullptr) return resident_->save();
  step_start_ = state_;
}

void Simulator::Impl::return_to_kept_state() {
  if (resident_ == nullptr) return set_state(step_start_);
  resident_->restore();
  is_state_here_ = false;
  largest_spin_ = kept_spin_;
}

/// After a part of a step. @returns whether all its numbers are finite
bool Simulator::Impl::take_state() {
  if (resident_ != nullptr) {
    is_state_here_ = false;
    const StateCheck check = resident_->check();
    largest_spin_ = check.largest_spin;
    return check.undefined == 0;
  }
  part_start_ = state_;
  stepper->get_state(state_);
  largest_spin_ = largest_spin();
  return is_finite_state(state_);
}

}  // namespace tetwarp

/// @file host_state.cpp
/// Copies the state of a stepper to the host when it is read.
#include "host/simulate/state/host_state.hpp"

#include <algorithm>
#include <utility>

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"
#include "host/simulate/step/scene_record.hpp"

namespace tetwarp {

HostState::HostState(const Model& model,
                     std::vector<Point3> moments,
                     BodyStepper& stepper,
                     ResidentState* resident)
    : model_(model),
      moments_(std::move(moments)),
      stepper_(stepper),
      resident_(resident),
      state_(model.start) {
  largest_spin_ = spin_on_host();
}

const ModelState& HostState::get() {
  if (!is_here_) stepper_.get_state(state_);
  is_here_ = true;
  return state_;
}

const ModelState& HostState::watched() {
  if (!is_here_) resident_->read_watched(state_);
  return state_;
}

double HostState::spin_on_host() const {
  double largest = 0;
  for (std::int32_t r = 0; r < model_.rigid_count; ++r) {
    if (at(moments_, r)[0] == 0) continue;
    largest = std::max(largest, norm(angular_velocity_of(model_, state_, r)));
  }
  return largest;
}

void HostState::set(const ModelState& next) {
  state_ = next;
  is_here_ = true;
  largest_spin_ = spin_on_host();
  stepper_.set_state(state_);
}

void HostState::keep() {
  kept_spin_ = largest_spin_;
  if (resident_ != nullptr) return resident_->save();
  kept_ = state_;
}

void HostState::go_back() {
  if (resident_ == nullptr) return set(kept_);
  resident_->restore();
  is_here_ = false;
  largest_spin_ = kept_spin_;
}

bool HostState::take() {
  if (resident_ != nullptr) {
    is_here_ = false;
    const StateCheck check = resident_->check();
    largest_spin_ = check.largest_spin;
    return check.undefined == 0;
  }
  before_part_ = state_;
  stepper_.get_state(state_);
  largest_spin_ = spin_on_host();
  return is_finite_state(state_);
}

}  // namespace tetwarp

/// @file step_start.cpp
/// Keeps the state before a step and restores it.
#include "host/simulate/run/step_start.hpp"

namespace tetwarp {

void StepStart::keep() {
  state_.keep();
  handles_ = drive_.handles();
  delays_ = drive_.delays();
  if (contact_ != nullptr) contact_->remember(memory_);
  asleep_ = sleep_.state();
}

void StepStart::go_back() {
  state_.go_back();
  drive_.handles() = handles_;
  drive_.delays() = delays_;
  if (contact_ != nullptr) contact_->restore(memory_);
  sleep_.set_state(asleep_);
}

}  // namespace tetwarp

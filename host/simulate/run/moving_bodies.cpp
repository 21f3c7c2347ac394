/// @file moving_bodies.cpp
/// One part of a step: inputs, solution without contact, contact, end.
#include "host/simulate/run/moving_bodies.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"
#include "host/base/step_second_fields.hpp"
#include "host/simulate/run/turning_moments.hpp"
#include "host/simulate/start/prepare_start.hpp"
#include "host/simulate/step/device_stepper.hpp"
#include "host/simulate/step/reference_stepper.hpp"

namespace tetwarp {

MovingBodies::MovingBodies(SimulatedScene& scene,
                           StepCount& count,
                           StepClock& clock,
                           std::optional<RestGrowth> growth)
    : scene_(scene),
      count_(count),
      clock_(clock),
      drive_(scene.scene, scene.geometry, scene.model),
      rest_factors_(std::make_shared<RestFactors>(scene.model)),
      contact_(make_contact()),
      growth_(growth ? std::move(*growth) : bring_apart(scene)),
      stepper_(make_stepper()),
      resident_(watch()),
      state_(scene.model, turning_moments(scene), *stepper_, resident_),
      sleep_(scene, contact_.get(), *stepper_, state_) {}

std::unique_ptr<ContactStep> MovingBodies::make_contact() {
  if (!ContactStep::can_touch(scene_.surfaces.surfaces)) return nullptr;
  ContactStepOptions of;
  of.backend = scene_.backend;
  of.threads = scene_.threads;
  of.device = scene_.options.device;
  of.skip = scene_.options.expert.skip;
  of.sleeps = scene_.scene.solver.sleeping;
  of.factors = rest_factors_;
  if (count_.has_progress()) of.progress = [this] { return count_.goes_on(0); };
  if (clock_.is_limited()) of.clock = &clock_;
  return std::make_unique<ContactStep>(scene_.scene, scene_.model, scene_.surfaces, of);
}

RestGrowth MovingBodies::bring_apart(SimulatedScene& scene) {
  if (!contact_) return {};
  const StartParts parts{scene.scene, scene.geometry, scene.surfaces, contact_->detector(),
                         scene.threads};
  RestGrowth growth = prepare_start(parts, scene.options.untangle, scene.model);
  if (scene.backend == Backend::reference && !growth.empty()) {
    throw std::invalid_argument(
        "untangle: backend reference cannot let bodies grow; use backend cpu");
  }
  return growth;
}

std::unique_ptr<BodyStepper> MovingBodies::make_stepper() {
  StepperOptions of;
  of.linear_tolerance = scene_.scene.solver.linear_tolerance;
  of.max_iterations = scene_.options.max_iterations;
  of.threads = scene_.threads;
  of.device = scene_.options.device;
  of.float32_solve = scene_.options.float32_solve;
  of.skip = scene_.options.expert.skip;
  of.factors = rest_factors_;
  if (count_.has_progress()) {
    of.progress = [this](std::int64_t iterations) { return count_.goes_on(iterations); };
  }
  if (clock_.is_limited()) of.clock = &clock_;
  if (scene_.backend == Backend::cuda) return make_cuda_stepper(scene_.model, of);
  if (scene_.backend == Backend::reference) {
    return make_reference_stepper(scene_.scene, scene_.geometry, scene_.model, drive_, of);
  }
  return make_cpu_stepper(scene_.model, of);
}

/// @returns null where the host reads every state: for contact, and to choose what sleeps
ResidentState* MovingBodies::watch() {
  if (contact_ || scene_.scene.solver.sleeping) return nullptr;
  DeviceStepper* const device = stepper_->on_device();
  if (device == nullptr) return nullptr;
  StatePlaces places;
  drive_.add_places(places);
  scene_.loads.add_places(places);
  for (auto* list : {&places.nodes, &places.rigid}) {
    std::sort(list->begin(), list->end());
    list->erase(std::unique(list->begin(), list->end()), list->end());
  }
  device->resident_state().watch(places);
  device->resident_state().watch_spins(turning_moments(scene_));
  return &device->resident_state();
}

void MovingBodies::begin_step() {
  state_.keep();
  start_ = memory();
}

void MovingBodies::go_back() {
  state_.go_back();
  set_memory(start_);
}

ContactPart MovingBodies::advance(const StepPart& part, StepAttempt& attempt) {
  fill_input(part);
  ContactPart contact;
  attempt.is_completed = solve(part, attempt, contact);
  if (!attempt.is_completed) return contact;
  attempt.is_finite = state_.take();
  if (contact_ && attempt.is_finite) contact_->end(state_.get(), contact);
  add_part(contact, attempt.contact);
  return contact;
}

void MovingBodies::fill_input(const StepPart& part) {
  const ModelState& state = state_.watched();
  drive_.fill(state, part.end_time, part.time_step, input_);
  scene_.loads.forces(state, part.end_time, input_.block_force);
  growth_.apply(scene_.model, state, input_);
  sleep_.begin_part(input_);
}

/// Moves the bodies. Where something reaches bodies that sleep, they wake and the part is solved
/// again. @returns false if `progress` ended it
bool MovingBodies::solve(const StepPart& part, StepAttempt& attempt, ContactPart& contact) {
  while (solve_without_waking(part, attempt, contact)) {
    if (contact.woken.empty()) return true;
    add_part(contact, attempt.contact);
    sleep_.wake(contact.woken, input_);
  }
  return false;
}

/// Solves for the velocities, and moves the bodies if no others have to wake first.
/// @returns false if `progress` ended it
bool MovingBodies::solve_without_waking(const StepPart& part,
                                        StepAttempt& attempt,
                                        ContactPart& contact) {
  if (contact_) input_.guess = contact_->guess(state_.get(), part.time_step);
  StepOutcome outcome = stepper_->solve(input_);
  add_seconds(outcome.seconds, attempt.outcome.seconds);
  count_.add_iterations(outcome.linear_iterations);
  if (!outcome.completed) return false;
  contact = {};
  if (contact_) {
    contact = contact_->advance(state_.get(), part.time_step, part.is_first, *stepper_);
  } else {
    contact.seconds.update = stepper_->move(part.time_step, {});
  }
  if (!contact.is_completed) return false;
  if (!contact.woken.empty()) {
    // The part is solved again: whether these solves have converged does not count.
    outcome.converged = contact.converged = true;
    outcome.linear_residual = contact.residual = 0;
  }
  add_outcome(outcome, attempt.outcome);
  return true;
}

void MovingBodies::end_part(const StepPart& part, StepSums& sums) {
  if (resident_ != nullptr) {
    resident_->add_sums(input_, sums);
    return drive_.accept();
  }
  std::vector<Point3> supports = stepper_->support_impulses();
  if (contact_) {
    const std::vector<Point3>& of_contacts = contact_->impulses().on_blocks();
    for (std::size_t block = 0; block < supports.size(); ++block) {
      if (scene_.model.prescribed[block] != 0) {
        supports[block] = minus(supports[block], of_contacts[block]);
      }
    }
    sums.add_contacts(contact_->impulses().on_bodies());
  }
  add_step(scene_.model, state_.before_part(), state_.get(), input_, supports, sums);
  drive_.accept();
  if (contact_) drive_.delay(contact_->fractions(), part.time_step);
  if (contact_ && clock_.was_over()) slow_down(contact_->fractions());
}

/// Where the step is out of time, bodies that moved only a part of it keep that part of their
/// velocities. With all of them, gravity would add speed in every step in which they are stopped:
/// the motion without contact would reach ever farther into other bodies, with ever more pairs.
void MovingBodies::slow_down(const std::vector<double>& fractions) {
  if (std::ranges::all_of(fractions, [](double fraction) { return fraction == 1; })) return;
  const Model& model = scene_.model;
  ModelState state = state_.get();
  for (std::size_t b = 0; b < model.body_rigid.size(); ++b) {
    const auto slow = [&](Point3& own) { own = times(fractions[b], own); };
    for (std::int32_t n = model.body_node[b]; n < model.body_node[b + 1]; ++n) {
      slow(state.velocity[index_of(n)]);
    }
    const std::int32_t rigid = model.body_rigid[b], block = model.node_count + 2 * rigid;
    if (rigid < 0) continue;
    slow(state.velocity[index_of(block)]);
    slow(state.velocity[index_of(block + 1)]);
    slow(state.angular_momentum[index_of(rigid)]);
  }
  state_.set(state);
}

void MovingBodies::end_step(bool may_sleep) {
  const bool grows = !growth_.empty() && count_.time() < RestGrowth::duration;
  sleep_.end_step(may_sleep && !grows, input_);
}

BodyMemory MovingBodies::memory() const {
  return {drive_.state(), contact_ ? contact_->memory() : ContactMemory{}, sleep_.state()};
}

void MovingBodies::set_memory(const BodyMemory& memory) {
  const auto& [drive, contacts, sleep] = memory;
  if (contact_) contact_->set_memory(contacts);
  drive_.set_state(drive);
  sleep_.set_state(sleep);
}

}  // namespace tetwarp

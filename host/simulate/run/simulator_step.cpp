#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

#include "host/simulate/run/simulator_impl.hpp"
#include "host/simulate/step/scene_record.hpp"

namespace tetwarp {
namespace {

constexpr double held_fraction = 0.05;  // of a step: bodies that move less are held up
constexpr int most_held_steps = 2;      // successive ones, before a step is divided
// After a step that the smallest parts did not help, so many steps are not divided for contact:
// bodies that are squeezed may stay so for long.
constexpr int steps_without_parts = 8;

void add_outcome(const StepOutcome& part, StepOutcome& sum) {
  sum.converged = sum.converged && part.converged;
  sum.linear_iterations += part.linear_iterations;
  sum.linear_residual = std::max(sum.linear_residual, part.linear_residual);
  sum.skipped_rotations += part.skipped_rotations;
  sum.skipped_blocks += part.skipped_blocks;
}

void add_seconds(const StepSeconds& part, StepSeconds& sum) {
  sum.forces += part.forces;
  sum.assembly += part.assembly;
  sum.linear += part.linear;
  sum.update += part.update;
}

}  // namespace

int Simulator::Impl::parts_for_spin() const {
  int parts = 1;
  while (2 * parts <= scene.solver.max_substeps && turns_too_far(scene.time_step / parts)) {
    parts *= 2;
  }
  return parts;
}

bool Simulator::Impl::is_good(const Attempt& result, const ContactPart& part, double time_step) {
  const std::int64_t counted = std::exchange(inverted_, -1);
  if (!result.is_finite || !result.outcome.converged) return false;
  if (turns_too_far(time_step)) return false;
  if (undivided_steps_ > 0) return true;
  if (!result.contact.converged) return false;
  if (part.smallest_fraction < held_fraction && held_steps_ >= most_held_steps) return false;
  if (part.contacts == 0) return true;
  const std::int64_t before = counted >= 0 ? counted : inverted_count(model, part_start_);
  inverted_ = inverted_count(model, state());
  return inverted_ <= before;
}

void Simulator::Impl::end_part(double time_step) {
  if (resident_ != nullptr) {
    resident_->add_sums(input_, sums_);
    return drive.accept();
  }
  std::vector<Point3> supports = stepper->support_impulses();
  if (contact_) {
    const std::vector<Point3>& of_contacts = contact_->impulses().on_blocks();
    for (std::size_t block = 0; block < supports.size(); ++block) {
      if (model.prescribed[block] != 0) {
        supports[block] = minus(supports[block], of_contacts[block]);
      }
    }
    sums_.add_contacts(contact_->impulses().on_bodies());
  }
  add_step(model, part_start_, state_, input_, supports, sums_);
  drive.accept();
  if (contact_) drive.delay(contact_->fractions(), time_step);
}

/// Solves and moves.
/// @returns false if `progress` ended it
bool Simulator::Impl::advance(int part, double time_step, Attempt& result) {
  if (contact_) input_.guess = contact_->guess(state_, time_step);
  StepOutcome outcome = stepper->solve(input_);
  add_seconds(outcome.seconds, result.outcome.seconds);
  iterations_before_ += outcome.linear_iterations;
  if (!outcome.completed) return false;
  ContactPart contact;
  if (contact_) {
    const bool is_first = step_index == 0 && part == 0;
    contact = contact_->advance(state_, time_step, is_first, *stepper, result.outcome.seconds);
    if (!contact.is_completed) return false;
    if (!contact.woken.empty()) {
      // The part is solved again: whether these solves have converged does not count.
      outcome.converged = contact.converged = true;
      outcome.linear_residual = contact.residual = 0;
      add_outcome(outcome, result.outcome);
      add_part(contact, result.contact);
      wake(contact.woken);
      return advance(part, time_step, result);
    }
  } else {
    result.outcome.seconds.update += stepper->move(time_step, {});
  }
  result.is_finite = take_state();
  if (contact_ && result.is_finite) contact_->end(state_, contact);
  add_outcome(outcome, result.outcome);
  add_part(contact, result.contact);
  result.is_good = is_good(result, contact, time_step) && result.is_good;
  return true;
}

Simulator::Impl::Attempt Simulator::Impl::attempt(int parts) {
  Attempt result;
  sums_.reset(scene.bodies.size(), scene.obstacles.size(), scene.couplings.size());
  const double dt = scene.time_step / parts;
  const auto index = static_cast<double>(step_index);
  for (int part = 0; part < parts; ++part) {
    const bool is_last = part + 1 == parts;
    const double end = time_of(is_last ? index + 1 : index + static_cast<double>(part + 1) / parts);
    if (!is_state_here_) resident_->read_watched(state_);
    drive.fill(state_, end, dt, input_);
    loads_.forces(state_, end, input_.block_force);
    growth_.apply(model, state_, input_);
    if (sleep_.is_on()) begin_sleep();
    try {
      result.is_completed = advance(part, dt, result);
    } catch (const TooManyPairs& error) {
      if (2 * parts > scene.solver.max_substeps) {
        throw std::runtime_error("step " + std::to_string(step_index) + ": " + error.what() +
                                 ", also in " + std::to_string(parts) +
                                 " substeps; reduce time_step or the speeds");
      }
      result.is_good = false;
      return result;
    }
    if (!result.is_completed) return result;
    if (!result.is_good && 2 * parts <= scene.solver.max_substeps) return result;
    if (!result.is_finite) return result;
    end_part(dt);
  }
  return result;
}

void Simulator::Impl::accept(const Attempt& made, int parts, const StepSeconds& seconds) {
  outcome_ = made.outcome;
  outcome_.seconds = seconds;
  contact_of_step_ = made.contact;
  substeps_ = parts;
  const bool is_held = made.contact.smallest_fraction < held_fraction;
  held_steps_ = is_held ? held_steps_ + 1 : 0;
  if (!made.is_good) {
    undivided_steps_ = steps_without_parts;
  } else if (undivided_steps_ > 0) {
    --undivided_steps_;
  }
  contact_points.clear();
  if (contact_) contact_->take_points(contact_points);
}

bool Simulator::Impl::take_steps() {
  const auto start = std::chrono::steady_clock::now();
  keep_state();
  const auto handles = drive.handles();
  const auto delays = drive.delays();
  const StepSums sums = sums_;
  if (contact_) contact_->remember(contact_start_);
  sleep_start_ = sleep_.state();
  const auto go_back = [&] {
    return_to_kept_state();
    drive.handles() = handles;
    drive.delays() = delays;
    inverted_ = -1;
    if (contact_) contact_->restore(contact_start_);
    sleep_.set_state(sleep_start_);
    sums_ = sums;
  };
  StepSeconds seconds;
  iterations_before_ = 0;
  for (int parts = parts_for_spin();; parts *= 2) {
    Attempt made;
    try {
      made = attempt(parts);
    } catch (...) {
      go_back();
      throw;
    }
    add_seconds(made.outcome.seconds, seconds);
    seconds.detection += made.contact.detection_seconds;
    seconds.contact += made.contact.contact_seconds;
    if (!made.is_completed) {
      go_back();
      return false;
    }
    const bool is_last = made.is_good || 2 * parts > scene.solver.max_substeps;
    if (!is_last) {
      go_back();
      continue;
    }
    if (!made.is_finite) {
      go_back();
      throw std::runtime_error("step " + std::to_string(step_index) +
                               ": positions would not be finite, also in " + std::to_string(parts) +
                               " substeps; reduce time_step or the stiffness");
    }
    try {
      if (sleep_.is_on()) fall_asleep(made);
    } catch (...) {
      go_back();
      throw;
    }
    const std::chrono::duration<double> total = std::chrono::steady_clock::now() - start;
    seconds.total = total.count();
    accept(made, parts, seconds);
    return true;
  }
}

bool Simulator::Impl::step() {
  if (!take_steps()) return false;
  work_ += sums_.work;
  ++step_index;
  record_.reset();
  return true;
}

}  // namespace tetwarp

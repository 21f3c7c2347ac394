#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "host/simulate/rotations.hpp"
#include "host/simulate/scene_record.hpp"
#include "host/simulate/simulator_impl.hpp"

namespace tetwarp {
namespace {

constexpr double largest_turn = 0.5;  // of a rigid body in a step [rad]

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

bool Simulator::Impl::turns_too_far(const ModelState& of, double time_step) const {
  for (std::int32_t r = 0; r < model.rigid_count; ++r) {
    if (at(model.rigid.mass, r) == 0) continue;
    const Point3 spin = angular_velocity_of(model, of, r);
    if (norm(spin) * time_step > largest_turn) return true;
  }
  return false;
}

int Simulator::Impl::parts_for_spin() const {
  int parts = 1;
  while (2 * parts <= scene.solver.max_substeps && turns_too_far(state, scene.time_step / parts)) {
    parts *= 2;
  }
  return parts;
}

Simulator::Impl::Attempt Simulator::Impl::attempt(int parts) {
  Attempt result;
  sums_.reset(scene.bodies.size(), scene.couplings.size());
  const double dt = scene.time_step / parts;
  const auto index = static_cast<double>(step_index);
  for (int part = 0; part < parts; ++part) {
    const bool is_last = part + 1 == parts;
    const double end = time_of(is_last ? index + 1 : index + static_cast<double>(part + 1) / parts);
    drive.fill(state, end, dt, input_);
    loads_.forces(state, end, input_.block_force);
    const StepOutcome outcome = stepper->step(input_);
    add_outcome(outcome, result.outcome);
    add_seconds(outcome.seconds, result.outcome.seconds);
    iterations_before_ += outcome.linear_iterations;
    if (!outcome.completed) {
      result.is_completed = false;
      return result;
    }
    part_start_ = state;
    stepper->get_state(state);
    result.is_finite = is_finite_state(state);
    result.is_good = result.is_finite && result.outcome.converged && !turns_too_far(state, dt);
    if (!result.is_good && 2 * parts <= scene.solver.max_substeps) return result;
    if (!result.is_finite) return result;
    add_step(model, part_start_, state, input_, stepper->support_impulses(), sums_);
    drive.accept();
  }
  return result;
}

bool Simulator::Impl::take_steps() {
  const auto start = std::chrono::steady_clock::now();
  step_start_ = state;
  const auto handles = drive.handles();
  const StepSums sums = sums_;
  const auto go_back = [&] {
    state = step_start_;
    stepper->set_state(state);
    drive.handles() = handles;
  };
  StepSeconds seconds;
  iterations_before_ = 0;
  for (int parts = parts_for_spin();; parts *= 2) {
    Attempt made;
    try {
      made = attempt(parts);
    } catch (...) {
      go_back();
      sums_ = sums;
      throw;
    }
    add_seconds(made.outcome.seconds, seconds);
    if (!made.is_completed) {
      go_back();
      sums_ = sums;
      return false;
    }
    const bool is_last = made.is_good || 2 * parts > scene.solver.max_substeps;
    if (!is_last) {
      go_back();
      continue;
    }
    if (!made.is_finite) {
      go_back();
      sums_ = sums;
      throw std::runtime_error("step " + std::to_string(step_index) +
                               ": positions would not be finite, also in " + std::to_string(parts) +
                               " substeps; reduce time_step or the stiffness");
    }
    outcome_ = made.outcome;
    substeps_ = parts;
    break;
  }
  const std::chrono::duration<double> total = std::chrono::steady_clock::now() - start;
  outcome_.seconds = seconds;
  outcome_.seconds.total = total.count();
  return true;
}

bool Simulator::Impl::step() {
  if (!take_steps()) return false;
  work_ += sums_.work;
  ++step_index;
  record_.reset();
  return true;
}

}  // namespace tetwarp

/// @file stack_steps.cpp
/// The whole contact problem of each step for residual_of().
#include "tests/simulate/stack_steps.hpp"

#include <gtest/gtest.h>

#include <cstdint>

#include "host/simulate/solve/problem/step_problem.hpp"
#include "host/simulate/solve/problem/step_rows.hpp"
#include "tests/simulate/body_models.hpp"

namespace tetwarp::test {
namespace {

ContactResidual exact_residual(const HandScene& scene,
                               const StepSystem& rows,
                               const ModelState& state,
                               const ContactTracker& tracker,
                               const std::vector<TrackedContact>& contacts,
                               const ContactSystem& system,
                               const std::vector<Point3>& velocity) {
  const ContactIslands islands(scene.surfaces, scene.model);
  StepRows jacobian(scene.surfaces, scene.model, 1);
  jacobian.begin(state, contacts);
  jacobian.set_all();
  std::vector<std::int32_t> all;
  for (std::size_t c = 0; c < contacts.size(); ++c) all.push_back(static_cast<std::int32_t>(c));
  StepProblem part;
  part.set_pattern(rows.rows, islands, jacobian.rows(),
                   std::vector<std::uint8_t>(at(scene.model.island_count), 1), all);
  part.set_numbers(rows);
  tracker.fill(part.problem());
  std::vector<double> dofs;
  for (std::int32_t row = 0; row < rows.rows.unknown_count; ++row) {
    const Point3& v = velocity[at(rows.rows.block_of[row])];
    dofs.insert(dofs.end(), v.begin(), v.end());
  }
  return residual_of(part.problem(), system.solution().impulse, dofs);
}

}  // namespace

std::vector<StackStep> run_stack(const HandScene& scene,
                                 const ContactSystemOptions& options,
                                 double adhesion,
                                 std::vector<Point3>* change,
                                 double friction,
                                 std::size_t count) {
  ContactTrackerOptions tracking;
  tracking.materials[0].friction = friction;
  tracking.materials[0].stiffness = adhesion;
  tracking.materials[0].initial_intensity = adhesion > 0 ? 0.5 : 0;
  tracking.touch_distance = 1e-9;
  const StepperOptions stepping = {.linear_tolerance = 1e-10};
  const auto stepper = options.solver.backend == Backend::cuda
                           ? make_cuda_stepper(scene.model, stepping)
                           : make_cpu_stepper(scene.model, stepping);
  ContactSystem system(scene.surfaces, scene.model, options);
  ContactTracker tracker(tracking);
  ModelState state = scene.model.start;
  std::vector<StackStep> steps(count);
  for (StackStep& step : steps) {
    stepper->solve(input_for(scene.model, stack_step, {3, 1, -9.81}));
    const std::vector<TrackedContact> contacts = scene.begin(tracker, state, stack_step);
    stepper->get_velocities(step.velocity);
    const StepSystem rows = stepper->system();
    step.outcome = system.solve(*stepper, state, tracker, contacts, step.velocity, change);

    step.residual = exact_residual(scene, rows, state, tracker, contacts, system, step.velocity);

    system.set_velocities(step.velocity, *stepper);
    std::vector<Point3> set;
    stepper->get_velocities(set);
    EXPECT_EQ(set, step.velocity);
    stepper->move(stack_step, {});
    stepper->get_state(state);
    tracker.end_step(system.solution(), scene.places(state));
  }
  return steps;
}

}  // namespace tetwarp::test

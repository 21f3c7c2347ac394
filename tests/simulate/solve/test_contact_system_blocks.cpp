/// Closed forms of contact of a rigid block with contacts by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "host/base/point3.hpp"
#include "tests/simulate/body_models.hpp"
#include "tests/simulate/mixed_contacts.hpp"

namespace tetwarp::test {
namespace {
constexpr double block_step = 8e-3;

struct BlockRun {
  ModelState state;
  ContactSolution solution;
  std::vector<Point3> impulses, on_prescribed, supports;
};

BlockRun run(const HandScene& scene,
             const ContactTrackerOptions& tracking,
             const StepInput& input,
             int steps) {
  StepperOptions stepping;
  stepping.linear_tolerance = 1e-14;
  ContactSystemOptions options;
  options.solver.tolerance = 1e-13;
  const auto stepper = make_cpu_stepper(scene.model, stepping);
  ContactSystem system(scene.surfaces, scene.model, options);
  ContactTracker tracker(tracking);
  BlockRun result;
  result.state = scene.model.start;
  std::vector<Point3> velocity;
  for (int n = 0; n < steps; ++n) {
    stepper->solve(input);
    const std::vector<TrackedContact> contacts = scene.begin(tracker, result.state, block_step);
    stepper->get_velocities(velocity);
    system.solve(*stepper, result.state, tracker, contacts, velocity);
    result.impulses = scene.block_impulses(result.state, contacts, system.solution().impulse);
    stepper->set_velocities(velocity);
    stepper->move(block_step, {});
    stepper->get_state(result.state);
    tracker.end_step(system.solution(), scene.places(result.state));
  }
  result.solution = system.solution();
  result.on_prescribed = system.block_impulses();
  result.supports = stepper->support_impulses();
  return result;
}

ContactTrackerOptions with_friction(double friction) {
  ContactTrackerOptions options;
  options.materials[0].friction = friction;
  return options;
}

/// Gravity of a plane that is tilted by the angle whose tangent is 0.5.
constexpr double slope = 0.5, g = 9.81;

TEST(ContactBlock, SticksBelowTheThresholdOfFriction) {
  const HandScene scene = stack_on_frame(1);
  const double c = 1 / std::sqrt(1 + slope * slope), s = slope * c;
  const StepInput input = input_for(scene.model, block_step, {g * s, 0, -g * c});

  const BlockRun stuck = run(scene, with_friction(slope / 0.999), input, 20);

  EXPECT_LT(norm(stuck.state.velocity[0]), 1e-10);
  EXPECT_LT(norm(stuck.state.velocity[1]), 1e-10);
}

TEST(ContactBlock, SlidesAboveTheThresholdOfFriction) {
  const HandScene scene = stack_on_frame(1);
  const double c = 1 / std::sqrt(1 + slope * slope), s = slope * c, mu = slope / 1.001;
  const StepInput input = input_for(scene.model, block_step, {g * s, 0, -g * c});

  const BlockRun slid = run(scene, with_friction(mu), input, 20);

  EXPECT_NEAR(slid.state.velocity[0][0], 20 * block_step * g * (s - mu * c), 1e-10);
  EXPECT_NEAR(slid.state.velocity[0][2], 0, 1e-10);
}

/// The frame carries the weight: its support takes up the impulses of the contacts.
TEST(ContactBlock, SupportOfAFrameHoldsTheWeight) {
  const HandScene scene = stack_on_frame(1);
  const StepInput input = input_for(scene.model, block_step, {0, 0, -g});

  const BlockRun rest = run(scene, with_friction(0.3), input, 5);

  EXPECT_NEAR(rest.impulses[0][2], block_step * g, 1e-12);
  EXPECT_NEAR(rest.impulses[2][2], -block_step * g, 1e-12);
  const Point3 none{0, 0, 0};
  EXPECT_EQ(rest.on_prescribed,
            (std::vector<Point3>{none, none, rest.impulses[2], rest.impulses[3]}));
  EXPECT_EQ(rest.supports[0], (Point3{0, 0, 0}));
}

/// A rising frame lifts the block, a sliding one drags it with friction.
TEST(ContactBlock, FollowsAMovingFrame) {
  const HandScene scene = stack_on_frame(1);
  StepInput input = input_for(scene.model, block_step, {0, 0, -g});
  input.prescribed_velocity[2] = {1, 0, 0.5};

  const BlockRun moved = run(scene, with_friction(0.2), input, 1);

  EXPECT_NEAR(moved.state.velocity[0][2], 0.5, 1e-10);
  EXPECT_NEAR(moved.state.velocity[0][0], 0.2 * (block_step * g + 0.5), 1e-10);
}

/// Penetration of 1 m is undone at 0.2 of the body's size per second, while the velocities that the
/// tracker gets are those of the gaps.
TEST(ContactBlock, RecoversFromPenetrationSlowly) {
  HandScene scene = stack_on_frame(1);
  scene.model.start.position[0][2] = -0.95;
  const StepInput input = input_for(scene.model, block_step, {0, 0, -g});

  const BlockRun raised = run(scene, with_friction(0), input, 1);

  EXPECT_NEAR(raised.state.velocity[0][2], 0.2 * 0.2, 1e-10);
  EXPECT_NEAR(raised.solution.velocity[0], -1 / block_step + 0.04, 1e-9);
}

/// A bonded block hangs below its frame at the gap m g / (area C), in traction all springs alike.
TEST(ContactBlock, HangsOnItsBonds) {
  HandScene scene = stack_on_frame(1);
  constexpr double area = 1e-3, stiffness = 1e6;
  for (Touch& touch : scene.touches) touch.area = area;
  ContactTrackerOptions tracking = with_friction(0.3);
  tracking.materials[0].stiffness = stiffness;
  tracking.materials[0].energy = 1e3;
  tracking.materials[0].initial_intensity = 1;
  tracking.touch_distance = 1e-9;
  const StepInput input = input_for(scene.model, block_step, {0, 0, g});

  const BlockRun hung = run(scene, tracking, input, 1);

  // One step of backward Euler from rest: (m + dt^2 k) v = dt m g.
  const double k = 4 * area * stiffness;
  EXPECT_NEAR(hung.state.velocity[0][2], block_step * g / (1 + block_step * block_step * k), 1e-12);
}

}  // namespace
}  // namespace tetwarp::test

/// Contacts of deformable bodies, solved where back end cuda steps them, against those on the host.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "host/base/point3.hpp"
#include "kernels/body/surface_move.hpp"
#include "kernels/exec/block_sum.cuh"
#include "tests/emulated/device_calls.hpp"
#include "tests/simulate/body_models.hpp"
#include "tests/simulate/mixed_contacts.hpp"
#include "tests/simulate/stack_scenes.hpp"

namespace tetwarp::test {
namespace {

struct StackStep {
  ContactSolveOutcome outcome;
  std::vector<Point3> velocity, block_impulses;
  simt::CopiedBytes copied;  ///< by ContactSystem::solve() and set_velocities()
  DeviceCalls calls{""};     ///< of them
};

/// Steps of a stack that is pushed sideways.
std::vector<StackStep> run_stack(const HandScene& scene,
                                 Backend backend,
                                 double tolerance,
                                 double adhesion = 0) {
  ContactSystemOptions options;
  options.solver.backend = backend;
  options.solver.tolerance = tolerance;
  options.recovery_fraction = 1e9;
  const StepperOptions stepping = {.linear_tolerance = 1e-12};
  const auto stepper = backend == Backend::cuda ? make_cuda_stepper(scene.model, stepping)
                                                : make_cpu_stepper(scene.model, stepping);
  ContactSystem system(scene.surfaces, scene.model, options);
  ContactTracker tracker(materials(0.4, adhesion));
  ModelState state = scene.model.start;
  std::vector<Point3> change;
  std::vector<StackStep> steps(3);
  for (StackStep& step : steps) {
    stepper->solve(input_for(scene.model, stack_step, {3, 1, -9.81}));
    const auto contacts = scene.begin(tracker, state, stack_step);
    stepper->get_velocities(step.velocity);
    take_copied();
    take_calls();
    step.outcome = system.solve(*stepper, state, tracker, contacts, step.velocity, &change);
    system.set_velocities(step.velocity, *stepper);
    step.copied = take_copied();
    step.calls = take_calls();
    step.block_impulses = scene.block_impulses(state, contacts, system.solution().impulse);

    // The velocities of the stepper are those of the solution, bit for bit.
    std::vector<Point3> of_stepper;
    stepper->get_velocities(of_stepper);
    EXPECT_EQ(of_stepper, step.velocity);
    stepper->move(stack_step, {});
    stepper->get_state(state);
    tracker.end_step(system.solution(), scene.places(state));
  }
  return steps;
}

double farthest(const std::vector<Point3>& a, const std::vector<Point3>& b) {
  double far = 0;
  for (std::size_t i = 0; i < a.size(); ++i) far = std::max(far, norm(minus(a[i], b[i])));
  return far;
}

/// @param near        of velocities [m/s] and of impulses on blocks [N s]
/// @param most_outer  outer iterations more than on the host
void expect_as_on_the_host(const HandScene& scene,
                           double tolerance,
                           double adhesion,
                           double near,
                           std::int64_t most_outer) {
  const auto expected = run_stack(scene, Backend::cpu, tolerance, adhesion);
  const auto found = run_stack(scene, Backend::cuda, tolerance, adhesion);
  for (std::size_t n = 0; n < found.size(); ++n) {
    SCOPED_TRACE(n);
    EXPECT_TRUE(found[n].outcome.converged && expected[n].outcome.converged);
    EXPECT_LE(found[n].outcome.residual, tolerance);
    EXPECT_LE(farthest(found[n].velocity, expected[n].velocity), near);
    EXPECT_LE(farthest(found[n].block_impulses, expected[n].block_impulses), near);
    EXPECT_LE(found[n].outcome.outer_iterations, expected[n].outcome.outer_iterations + most_outer);
    EXPECT_GT(found[n].calls.count(DeviceCall::launch), 0);
  }
}

TEST(TwoLevelEmulated, ATowerOfElasticBlocksIsSolvedAsOnTheHost) {
  expect_as_on_the_host(tower_scene(1, 2), 1e-7, 4e7, 1e-6, 3);
}

TEST(LongTwoLevelEmulated, AStackIsSolvedAsOnTheHost) {
  for (const double youngs : {1e4, 1e6}) {
    for (const double adhesion : {0.0, 4e7}) {
      SCOPED_TRACE(testing::Message() << youngs << " " << adhesion);
      expect_as_on_the_host(stack_scene(youngs), 1e-8, adhesion, 2e-7, 3);
    }
  }
}

TEST(LongTwoLevelEmulated, ATowerOfElasticBlocksIsSolvedAsOnTheHost) {
  expect_as_on_the_host(tower_scene(1, 6), 1e-7, 4e7, 1e-6, 3);
}

/// The inverses at rest of bodies that are pressed flat are far from those of their systems.
TEST(LongTwoLevelEmulated, BlocksPressedFlatAreSolvedAsOnTheHost) {
  expect_as_on_the_host(tower_scene(0.3, 6), 1e-6, 0, 1e-5, 3);
}

/// Inverses rounded to float32 of bodies this stiff may not be positive.
TEST(LongTwoLevelEmulated, AVeryStiffStackIsSolvedAsOnTheHost) {
  expect_as_on_the_host(stack_scene(1e9), 1e-5, 0, 5e-4, 1000);
}

/// A first step on the emulated device.
struct FirstStep {
  StackStep solved;
  std::vector<Point3> before;  ///< velocities without contact
  double change() const { return farthest(solved.velocity, before); }
};

FirstStep first_step(const HandScene& scene,
                     const ContactSystemOptions& options,
                     const Point3& acceleration = {3, 1, -9.81},
                     double friction = 0.4) {
  const auto stepper = make_cuda_stepper(scene.model, {.linear_tolerance = 1e-12});
  ContactSystem system(scene.surfaces, scene.model, options);
  ContactTracker tracker(materials(friction));
  stepper->solve(input_for(scene.model, stack_step, acceleration));
  const auto contacts = scene.begin(tracker, scene.model.start, stack_step);
  FirstStep step;
  stepper->get_velocities(step.before);
  StackStep& solved = step.solved;
  solved.velocity = step.before;
  take_copied();
  take_calls();
  solved.outcome = system.solve(*stepper, scene.model.start, tracker, contacts, solved.velocity);
  solved.copied = take_copied();
  solved.calls = take_calls();
  solved.block_impulses =
      scene.block_impulses(scene.model.start, contacts, system.solution().impulse);
  return step;
}

TEST(TwoLevelEmulated, IslandsWithoutContactsKeepTheirVelocities) {
  HandScene scene = stack_scene(1e5);
  scene.touches.clear();
  ContactSystemOptions options = exact(Backend::cuda);
  options.skips_islands = false;
  const FirstStep step = first_step(scene, options);
  EXPECT_TRUE(step.solved.outcome.converged);
  EXPECT_LE(step.change(), 1e-9);
}

TEST(TwoLevelEmulated, ProgressStopsASolve) {
  ContactSystemOptions options = exact(Backend::cuda);
  int calls = 0;
  options.solver.progress = [&](const ContactProgress&) { return ++calls < 2; };
  EXPECT_FALSE(first_step(stack_scene(1e6), options).solved.outcome.converged);
  EXPECT_EQ(calls, 2);
}

/// The same step with contacts solved on the host, from the system of the emulated device.
/// @param tries  whether the device tries first
void expect_solved_on_the_host(const HandScene& scene, bool tries) {
  ContactSystemOptions options;
  options.solver.tolerance = 1e-5;
  const StackStep host = first_step(scene, options).solved;
  options.solver.backend = Backend::cuda;
  const StackStep found = first_step(scene, options).solved;
  EXPECT_TRUE(found.outcome.converged);
  EXPECT_EQ(found.outcome.residual, host.outcome.residual);
  EXPECT_EQ(found.velocity, host.velocity);
  EXPECT_EQ(found.block_impulses, host.block_impulses);
  EXPECT_GE(found.copied.to_host, host.copied.to_host);  // the system
  EXPECT_EQ(host.calls.count(DeviceCall::launch), 0);
  EXPECT_EQ(found.calls.count(DeviceCall::launch) > 0, tries);
  EXPECT_EQ(found.outcome.sweeps > host.outcome.sweeps, tries);
}

/// Rounded to float32 the inverse of the block is not positive.
TEST(TwoLevelEmulated, WhatDoesNotConvergeIsSolvedByTheHost) {
  expect_solved_on_the_host(stack_scene(1e11), true);
}

TEST(TwoLevelEmulated, BodiesTooLargeForAnInverseAreSolvedByTheHost) {
  HandScene scene;
  scene.model = empty_model();
  add_block(scene.model, {.cells = {125, 3, 1}, .edge = 0.005, .youngs = 1e3});
  ASSERT_EQ(scene.model.node_count, 1008);
  const std::int32_t frame = add_frame(scene.model, {0, 0, 0});
  scene.make_surfaces(0.02);
  for (std::int32_t node = 0; node < 504; node += 50) {
    Touch touch;
    touch.body_b = scene.model.rigid.body[static_cast<std::size_t>(frame)];
    touch.point_a = on_nodes({node, -1, -1}, {1, 0, 0});
    touch.point_b = on_rigid(scene.model.start.position[static_cast<std::size_t>(node)]);
    scene.touches.push_back(touch);
  }
  expect_solved_on_the_host(scene, false);
}

/// Copies within the device: three as a solve begins, two per outer iteration, and three where its
/// steps begin, which they do anew with twice the majorant.
TEST(TwoLevelEmulated, StepsBeginAnewWhereAnEigenvalueIsMissed) {
  ContactSystemOptions options = exact(Backend::cuda);
  options.solver.tolerance = 1e-8;
  const Point3 push = {-10, 0, 0};
  const StackStep found = first_step(rods_scene(), options, push, 0).solved;
  options.solver.backend = Backend::cpu;
  const StackStep host = first_step(rods_scene(), options, push, 0).solved;
  EXPECT_TRUE(found.outcome.converged);
  EXPECT_EQ(found.calls.count(DeviceCall::copy_within), 3 + 5 * found.outcome.outer_iterations + 3);
  EXPECT_LT(found.outcome.sweeps, 300);
  EXPECT_LE(farthest(found.velocity, host.velocity), 1e-9);
  EXPECT_LE(farthest(found.block_impulses, host.block_impulses), 1e-9);
  EXPECT_NEAR(norm(found.block_impulses[2]), 0.1 * 10 * stack_step, 1e-9);
}

/// Loops have a block for each multiprocessor or blocks of one warp, so that no multiprocessor
/// waits for another one's long bodies. Sums have one term per thread.
TEST(TwoLevelEmulated, LaunchesFillADevice) {
  simt::Device::only().multiprocessors = 132;
  const HandScene scene = stack_scene(1e6);
  ContactSystemOptions options = exact(Backend::cuda);
  options.solver.tolerance = 1e-4;
  take_launches();
  const FirstStep step = first_step(scene, options);
  simt::Device::only().multiprocessors = 4;
  ASSERT_TRUE(step.solved.outcome.converged);
  const auto contacts = static_cast<std::int64_t>(scene.touches.size());
  bool has_pushed = false, has_stepped = false;
  for (const simt::LaunchShape& launch : take_launches()) {
    SCOPED_TRACE(launch.kernel);
    const auto is_of = [&](const char* op) { return launch.kernel.find(op) != std::string::npos; };
    if (is_of("Sum") || is_of("FlagCount")) {
      EXPECT_EQ(launch.threads, sum_threads);
    } else if (!is_of("scan") && !is_of("GradientArrays")) {
      EXPECT_TRUE(launch.blocks >= 132 || launch.threads == 32)
          << launch.blocks << " " << launch.threads;
    }
    has_pushed = has_pushed || (is_of("NodePushOp") && launch.blocks > 1);
    has_stepped =
        has_stepped || (is_of("ProximalStepOp") && launch.blocks * launch.threads >= 4 * contacts);
  }
  EXPECT_TRUE(has_pushed && has_stepped);
}

/// Nothing of A is copied, nor of J: of contacts their points and laws, of nodes that may move the
/// change of the step before. What surfaces are bound to, lists of rows, and the inverse of the
/// block are copied once.
TEST(TwoLevelEmulated, TheSystemStaysOnTheDevice) {
  const HandScene scene = stack_scene(1e6);
  const auto steps = run_stack(scene, Backend::cuda, 1e-4);
  const auto contacts = static_cast<std::size_t>(scene.touches.size());
  const std::size_t nodes = 100, rows = nodes + 2;
  const std::size_t inverse = 9 * nodes * nodes * sizeof(float);
  const std::size_t in_each = 400 * contacts + 24 * rows + 1024;
  EXPECT_GE(steps[0].copied.to_device, inverse);
  EXPECT_LE(steps[0].copied.to_device,
            inverse + sizeof(SurfacePoint) * nodes + 16 * rows + in_each);
  for (std::size_t n = 1; n < steps.size(); ++n) {
    SCOPED_TRACE(n);
    const StackStep& step = steps[n];
    EXPECT_LE(step.copied.to_device, in_each);
    const auto reads = static_cast<std::size_t>(step.calls.count(DeviceCall::copy_to_host));
    EXPECT_LE(step.copied.to_host, 48 * contacts + 24 * rows + 40 * reads);
    // Two per outer iteration, one per eight steps.
    EXPECT_LE(static_cast<std::int64_t>(reads),
              4 + 2 * step.outcome.outer_iterations + step.outcome.sweeps / 8);
    EXPECT_LE(step.calls.count(DeviceCall::copy_to_device), 5);
    // All runs of eight steps but the first.
    EXPECT_EQ(step.calls.count(DeviceCall::graph), step.outcome.sweeps / 8 - 1);
  }
  EXPECT_EQ(steps[2].calls.count(DeviceCall::allocate), 0);
}

}  // namespace
}  // namespace tetwarp::test

/// Convergence of contacts on the emulated device, by a factorization of A, and what the check of
/// it takes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "tests/emulated/check_of_step.hpp"
#include "tests/emulated/device_calls.hpp"
#include "tests/simulate/body_models.hpp"
#include "tests/simulate/mixed_contacts.hpp"
#include "tests/simulate/stack_steps.hpp"

namespace tetwarp::test {
namespace {

ContactSystemOptions on_device(double tolerance) {
  ContactSystemOptions options;
  options.recovery_fraction = 1e9;
  options.solver.backend = Backend::cuda;
  options.solver.tolerance = tolerance;
  return options;
}

struct TiedOptions {
  double youngs, spring, adhesion, tolerance;
  std::size_t steps;
};
void expect_tied_bodies_meet(const TiedOptions& of) {
  SCOPED_TRACE(testing::Message() << of.youngs << " " << of.spring << " " << of.adhesion);
  const HandScene scene = tied_scene(of.youngs, of.spring);
  const auto steps = run_stack(scene, on_device(of.tolerance), of.adhesion, nullptr, 0.4, of.steps);
  for (const StackStep& step : steps) {
    EXPECT_TRUE(step.outcome.converged);
    EXPECT_LE(step.outcome.residual, of.tolerance);
    EXPECT_LE(step.residual.eta, 1.5 * of.tolerance);
  }
}

/// Of bodies that springs join M is far from A, whose residual counts.
TEST(ResidualCheckEmulated, TiedBodiesMeetTheTolerance) {
  expect_tied_bodies_meet({1e6, 1e2, 0, 1e-4, 1});
}

TEST(LongResidualCheckEmulated, TiedBodiesMeetTheTolerance) {
  expect_tied_bodies_meet({1e4, 1e2, 0, 1e-4, 1});
  expect_tied_bodies_meet({1e6, 1e2, 4e7, 1e-4, 1});
  expect_tied_bodies_meet({1e8, 1e2, 0, 1e-4, 1});
}

/// @param steps  in all; all or all but one converge
void expect_sheets_meet(double stiffness, std::int32_t cells, std::size_t steps) {
  SCOPED_TRACE(testing::Message() << stiffness << " " << cells);
  std::size_t converged = 0;
  const HandScene scene = sheet_scene(stiffness, cells);
  for (const StackStep& step : run_stack(scene, on_device(1e-4), 0, nullptr, 0.4, steps)) {
    if (!step.outcome.converged) continue;
    ++converged;
    EXPECT_LE(step.residual.eta, 1.5e-4);
  }
  EXPECT_GE(converged, steps - 1);
}

TEST(ResidualCheckEmulated, SheetsWithFrictionAreNotCalledConvergedTooEarly) {
  expect_sheets_meet(1e3, 4, 2);
}

TEST(LongResidualCheckEmulated, StiffSheetsWithFrictionAreNotCalledConvergedTooEarly) {
  expect_sheets_meet(1e5, 4, 2);
}

/// The first step of a sheet on the device.
struct SheetStep {
  ContactSolveOutcome outcome;
  DeviceCalls calls{""};
  std::set<simt::LaunchShape> launches;
};
SheetStep sheet_step(ContactSystemOptions options) {
  const HandScene scene = sheet_scene(1e3, 4);
  const auto stepper = make_cuda_stepper(scene.model, {.linear_tolerance = 1e-10});
  ContactSystem system(scene.surfaces, scene.model, options);
  ContactTracker tracker(materials(0.4));
  SheetStep step;
  for (int n = 0; n < 2; ++n) {  // memory is taken in the first solve
    stepper->solve(input_for(scene.model, stack_step, {3, 1, -9.81}));
    const auto contacts = scene.begin(tracker, scene.model.start, stack_step);
    std::vector<Point3> velocity;
    stepper->get_velocities(velocity);
    system.begin_part();
    take_calls();
    take_launches();
    step.outcome = system.solve(*stepper, scene.model.start, tracker, contacts, velocity);
    step.calls = take_calls();
    step.launches = take_launches();
  }
  return step;
}

bool has_check(const std::set<simt::LaunchShape>& launches) {
  return std::ranges::any_of(launches, [](const simt::LaunchShape& launch) {
    return launch.kernel.find("ResidualCheckJob") != std::string::npos;
  });
}

/// A check is two launches and one read. A solve checks once, or a few times where the first
/// iterates within the tolerance are off by the check.
TEST(ResidualCheckEmulated, ACheckTakesOneReadAndNoMemory) {
  const SheetStep step = sheet_step(on_device(1e-4));
  EXPECT_TRUE(step.outcome.converged);
  EXPECT_TRUE(has_check(step.launches));
  EXPECT_EQ(step.calls.count(DeviceCall::allocate), 0);
  // Two per outer iteration, one per eight steps, five as it begins and ends, and the checks.
  const std::int64_t of_iteration = 5 + 2 * step.outcome.outer_iterations + step.outcome.sweeps / 8;
  EXPECT_LE(step.calls.count(DeviceCall::copy_to_host), of_iteration + 3);
}

TEST(ResidualCheckEmulated, DevicesThatSynchronizeNoGridLeaveJoinedBodiesToTheHost) {
  simt::Device::only().is_cooperative = 0;
  const SheetStep step = sheet_step(on_device(1e-4));
  simt::Device::only().is_cooperative = 1;
  EXPECT_TRUE(step.outcome.converged);
  EXPECT_FALSE(has_check(step.launches));
}

/// In any order of threads, too, and with several launches.
TEST(ResidualCheckEmulated, GridsOfAnySizeGiveTheSameBits) {
  for (const std::int32_t size : {1, 33, 150}) {
    SCOPED_TRACE(size);
    CheckOfStep check(size);
    const ResidualCheckState one = check.run(1, CausedProgress::most_iterations);
    EXPECT_EQ(one.progress.end, CausedProgress::End::found);
    EXPECT_GT(one.eta, 0);
    const auto expect_same = [&](const ResidualCheckState& other) {
      EXPECT_EQ(other.eta, one.eta);
      EXPECT_EQ(other.progress.iterations, one.progress.iterations);
    };
    for (const unsigned blocks : {2u, 5u}) expect_same(check.run(blocks, 1000));
    simt::for_each_schedule([&](const simt::Schedule&) { expect_same(check.run(2, 2)); });
  }
}

}  // namespace
}  // namespace tetwarp::test

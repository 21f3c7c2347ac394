/// @file test_contact_emulated.cpp
/// Calls of the contact solver to the emulated device, which records every call and runs threads in
/// several orders.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include <tetwarp/contact.hpp>

#include "host/contact/sweeps/method_names.hpp"
#include "tests/support/contact/contact_methods.hpp"
#include "tests/support/contact/contact_scenes.hpp"
#include "tests/support/elastic_block.hpp"

#include "tests/emulated/device_calls.hpp"

namespace tetwarp::test {
namespace {
DeviceCalls calls_of(ContactSolver& solver, const ContactProblem& problem) {
  take_calls();
  EXPECT_TRUE(solver.solve(problem).converged());
  return take_calls();
}

/// Small islands, a large one, elastic bodies.
TEST(ContactEmulated, ASolverThatGoesOnAllocatesNothing) {
  ContactOptions large = {.tolerance = 1e-2, .backend = Backend::cuda};
  large.expert.skip.converged_islands = false;
  ContactOptions elastic = iterated();
  elastic.tolerance = 1e-4;
  elastic.backend = Backend::cuda;
  const struct {
    ContactProblem problem;
    ContactOptions options;
  } cases[] = {
      {scenes::sphere_packing({.seed = 321, .edge = 4, .kept = 0.3}), {.backend = Backend::cuda}},
      {scenes::random_local({.seed = 322, .contacts = 2049, .neighbors = 2}), large},
      {make_elastic_problem({}), elastic}};
  for (const auto& [problem, options] : cases) {
    ContactSolver solver(options);
    EXPECT_GT(calls_of(solver, problem).count(DeviceCall::allocate), 10);

    const DeviceCalls calls = calls_of(solver, problem);

    EXPECT_EQ(calls.count(DeviceCall::allocate), 0);
    EXPECT_EQ(calls.count(DeviceCall::release), 0);
    EXPECT_GT(calls.count(DeviceCall::launch), 5);
  }
}

/// From the upload of the numbers to impulses: measuring before and after, and one launch between.
TEST(ContactEmulated, SmallIslandsTakeOneLaunchAndThreeReads) {
  const ContactProblem problem = scenes::sphere_packing({.seed = 323, .edge = 4, .kept = 0.3});
  ContactSolver few({.tolerance = 1e-2, .backend = Backend::cuda});
  ContactSolver many({.tolerance = 1e-10, .backend = Backend::cuda});
  calls_of(few, problem);
  calls_of(many, problem);

  const DeviceCalls short_solve = calls_of(few, problem), long_solve = calls_of(many, problem);

  EXPECT_EQ(short_solve, long_solve);  // for any number of sweeps
  EXPECT_LE(long_solve.count(DeviceCall::launch), 12);
}

/// Every method, by one launch on the whole device and stage by stage.
TEST(LongContactEmulated, LargeIslandsHaveTheSameBitsWithAndWithoutSynchronizedGrids) {
  const ContactProblem problem =
      scenes::random_local({.seed = 325, .contacts = 2049, .neighbors = 2});
  const ContactProblem stack = scenes::box_stack({.boxes = 513});
  for (const ContactMethod method : methods) {
    for (const ContactProblem* const each : {&problem, &stack}) {
      if (each == &stack && method != ContactMethod::automatic) continue;
      ContactOptions options = {.method = method, .tolerance = 1e-3, .backend = Backend::cuda};
      options.max_sweeps = 60;
      options.max_newton = 0;
      options.expert.skip.converged_islands = false;
      simt::Device::only().is_cooperative = 0;
      ContactSolver by_stages(options);
      simt::Device::only().is_cooperative = 1;
      ContactSolver by_grid(options);
      const ContactSolution wanted = by_stages.solve(*each), solution = by_grid.solve(*each);
      EXPECT_EQ(solution.impulse, wanted.impulse) << report_name_of(method);
      EXPECT_EQ(solution.body_velocity, wanted.body_velocity) << report_name_of(method);
      EXPECT_EQ(solution.report.sweeps, wanted.report.sweeps) << report_name_of(method);
      EXPECT_EQ(solution.report.residual_history, wanted.report.residual_history);
    }
  }
}

/// The number of launches and reads does not depend on the number of sweeps.
TEST(ContactEmulated, LargeIslandsAreSolvedByOneLaunch) {
  const ContactProblem problem =
      scenes::random_local({.seed = 326, .contacts = 2049, .neighbors = 2});
  ContactOptions options = {.tolerance = 1e-2, .backend = Backend::cuda};
  options.expert.skip.converged_islands = false;
  ContactSolver few(options);
  options.tolerance = 1e-6;
  ContactSolver many(options);
  calls_of(few, problem);
  calls_of(many, problem);

  EXPECT_EQ(calls_of(few, problem), calls_of(many, problem));
}

TEST(ContactEmulated, HasTheSameBitsInAnyOrderOfThreads) {
  const ContactProblem problem = scenes::sphere_packing({.seed = 324, .edge = 4, .kept = 0.4});
  ContactSolver solver({.backend = Backend::cuda});
  const ContactSolution first = solver.solve(problem);

  simt::for_each_schedule([&](const simt::Schedule&) {
    expect_same_bits(solver.solve(problem), first, "another order of threads");
  });
}
}  // namespace
}  // namespace tetwarp::test

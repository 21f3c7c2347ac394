/// @file test_contact_emulated.cpp
/// What the contact solver asks of its device, seen on the emulated one, which writes down every
/// call and runs threads in several orders.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include <tetwarp/contact.hpp>

#include "tests/scenes/contact_methods.hpp"
#include "tests/scenes/contact_scenes.hpp"
#include "tests/scenes/elastic_block.hpp"

#include "kernels/exec/launch.hpp"

namespace tetwarp::test {
namespace {

std::string calls_of(ContactSolver& solver, const ContactProblem& problem) {
  simt::Device::only().take_calls();
  EXPECT_TRUE(solver.solve(problem).converged());
  return simt::Device::only().take_calls();
}

auto count_of(const std::string& calls, simt::ApiCall call) {
  return std::count(calls.begin(), calls.end(), static_cast<char>(call));
}

/// Small islands, a large one, elastic bodies.
TEST(ContactEmulated, ASolverThatGoesOnAllocatesNothing) {
  ContactOptions large = {.tolerance = 1e-2, .backend = Backend::cuda};
  large.skip.converged_islands = false;
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
    EXPECT_GT(count_of(calls_of(solver, problem), simt::ApiCall::allocate), 10);

    const std::string calls = calls_of(solver, problem);

    EXPECT_EQ(count_of(calls, simt::ApiCall::allocate), 0);
    EXPECT_EQ(count_of(calls, simt::ApiCall::release), 0);
    EXPECT_GT(count_of(calls, simt::ApiCall::launch), 5);
  }
}

/// From the upload of the numbers to impulses: measuring before and after, and one launch between.
TEST(ContactEmulated, SmallIslandsTakeOneLaunchAndThreeReads) {
  const ContactProblem problem = scenes::sphere_packing({.seed = 323, .edge = 4, .kept = 0.3});
  ContactSolver few({.tolerance = 1e-2, .backend = Backend::cuda});
  ContactSolver many({.tolerance = 1e-10, .backend = Backend::cuda});
  calls_of(few, problem);
  calls_of(many, problem);

  const std::string short_solve = calls_of(few, problem), long_solve = calls_of(many, problem);

  EXPECT_EQ(short_solve, long_solve);  // whatever the number of sweeps
  EXPECT_LE(count_of(long_solve, simt::ApiCall::launch), 12);
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

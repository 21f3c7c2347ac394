/// @file test_contact_budget.cpp
/// Limits of a solve: time, Newton steps, memory, cancellation.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>

#include <tetwarp/contact.hpp>

#include "tests/support/contact/contact_samples.hpp"
#include "tests/support/contact/contact_scenes.hpp"

namespace tetwarp::test {
namespace {
constexpr std::int64_t many = std::int64_t{1} << 40;
constexpr double unreachable = 1e-300;

ContactProblem dense_problem(std::int64_t contacts) {
  std::mt19937 random(7);
  return samples::random_local(random, contacts, 0.6, {});
}

bool has_reason(const ContactSolution& solution, const std::string& words) {
  return solution.report.status == ContactStatus::not_converged &&
         solution.report.status_reason.find(words) != std::string::npos;
}

void expect_finite(const ContactSolution& solution) {
  for (const std::vector<double>* values : {&solution.impulse, &solution.body_velocity}) {
    for (const double value : *values) EXPECT_TRUE(std::isfinite(value));
  }
}
}  // namespace

/// The limits of sweeps would allow hours.
TEST(ContactBudget, TimeEndsEveryPhase) {
  const ContactProblem local = dense_problem(30);
  const ContactProblem elastic = scenes::elastic_slab({.cubes = {6, 6, 3}, .contacts = 30});
  for (const ContactMethod method : {ContactMethod::gauss_seidel, ContactMethod::nonlinear_cg,
                                     ContactMethod::anderson, ContactMethod::automatic}) {
    const ContactOptions options = {
        .method = method, .tolerance = unreachable, .max_sweeps = many, .max_seconds = 0.1};
    const ContactSolution solution = solve_contacts(local, options);

    EXPECT_TRUE(has_reason(solution, "max_seconds")) << solution.report.status_reason;
    EXPECT_LT(solution.report.total_seconds, 2);  // the machine may be busy
    EXPECT_LT(solution.report.residual.eta, 1e-2);
  }
  const ContactSolution solution =
      solve_contacts(elastic, {.tolerance = unreachable,
                               .max_sweeps = many,
                               .expert = {.coupling = ContactCoupling::iterated},
                               .max_seconds = 0.1});
  EXPECT_TRUE(has_reason(solution, "max_seconds")) << solution.report.status_reason;
  EXPECT_LT(solution.report.total_seconds, 2);
  expect_finite(solution);
}

TEST(ContactBudget, NewtonStepsAreLimited) {
  for (const std::int64_t limit : {0, 1, 5}) {
    const ContactSolution solution =
        solve_contacts(dense_problem(30), {.method = ContactMethod::newton,
                                           .tolerance = unreachable,
                                           .max_sweeps = 3,
                                           .max_newton = limit});

    EXPECT_LE(solution.report.newton_iterations, limit);
    EXPECT_TRUE(has_reason(solution, "max_newton")) << solution.report.status_reason;
  }
}

TEST(ContactBudget, MemoryLimitKeepsNewtonAndCondensingFromRunning) {
  const ContactSolution newton =
      solve_contacts(dense_problem(30), {.tolerance = 1e-14, .max_sweeps = 3, .max_memory = 1000});
  EXPECT_EQ(newton.report.newton_iterations, 0);
  EXPECT_TRUE(has_reason(newton, "max_memory")) << newton.report.status_reason;

  const ContactProblem elastic = scenes::elastic_slab({.cubes = {3, 3, 2}, .contacts = 5});
  const ContactSolution iterated = solve_contacts(
      elastic, {.expert = {.coupling = ContactCoupling::condensed}, .max_memory = 1000});
  EXPECT_GT(iterated.report.outer_iterations, 0);
  EXPECT_TRUE(iterated.converged()) << iterated.report.status_reason;
}

/// Cancelled at the first call, in the middle and late; in sweeps, Newton steps and condensing.
TEST(ContactBudget, TheCallbackCancelsAnywhere) {
  const ContactProblem local = dense_problem(20);
  const ContactProblem elastic = scenes::elastic_slab({.cubes = {4, 4, 2}, .contacts = 20});
  for (const int calls : {0, 1, 2, 5, 30}) {
    for (const ContactCoupling coupling : {ContactCoupling::condensed, ContactCoupling::iterated}) {
      for (const ContactProblem* problem : {&local, &elastic}) {
        int left = calls;
        const ContactSolution solution = solve_contacts(
            *problem, {.tolerance = unreachable,
                       .max_sweeps = 20,
                       .expert = {.coupling = coupling},
                       .progress = [&](const ContactProgress&) { return left-- > 0; }});

        EXPECT_TRUE(has_reason(solution, "cancelled")) << solution.report.status_reason;
        EXPECT_EQ(left, -1) << "called again after the cancellation";
        expect_finite(solution);
      }
    }
  }
}

TEST(ContactBudget, WhatTheCallbackThrowsLeavesTheSolve) {
  ContactSolver solver(
      {.progress = [](const ContactProgress&) -> bool { throw std::runtime_error("stop"); }});
  EXPECT_THROW(solver.solve(dense_problem(5)), std::runtime_error);
}

TEST(ContactBudget, LimitsThatAreNotReachedDoNotChangeABit) {
  const ContactProblem problem = dense_problem(20);
  const ContactSolution plain = solve_contacts(problem, {.tolerance = 1e-9});
  std::int64_t sweeps = -1;
  const ContactSolution watched =
      solve_contacts(problem, {.tolerance = 1e-9,
                               .max_seconds = 1e6,
                               .max_newton = 1000000,
                               .max_memory = many,
                               .progress = [&](const ContactProgress& progress) {
                                 EXPECT_GE(progress.sweeps, sweeps);
                                 sweeps = progress.sweeps;
                                 return true;
                               }});

  EXPECT_EQ(plain.impulse, watched.impulse);
  EXPECT_EQ(plain.report.sweeps, watched.report.sweeps);
  EXPECT_GT(sweeps, 0);
}

}  // namespace tetwarp::test

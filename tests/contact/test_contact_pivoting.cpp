/// @file test_contact_pivoting.cpp
/// Lemke's pivoting on problems that the friction pyramid solves by construction, and on problems
/// that have no solution with it.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>

#include <tetwarp/contact.hpp>

#include "host/contact/newton/pivoting.hpp"
#include "host/reference/contact/dense.hpp"
#include "tests/support/solvability.hpp"

namespace tetwarp::test {
namespace {
using samples::Solvability;
const ContactOptions pyramid{.law = FrictionLaw::pyramid};

/// Error of the first solution of up to 64 starts; infinity where there is none.
double first_error(const ContactProblem& problem) {
  const FrictionPivoting pivoting(problem, pyramid);
  for (std::uint32_t start = 0; start < 64; ++start) {
    const std::optional<std::vector<double>> impulse = pivoting.solve(start);
    if (!impulse) continue;
    const reference::DenseContacts dense = reference::make_dense(problem, pyramid.recovery_speed);
    return reference::eta_of(dense, samples::vector_of(*impulse), pyramid);
  }
  return INFINITY;
}
}  // namespace

/// Many of these have directions along which impulses can grow, so that not every path ends at a
/// solution. One that does is as exact as the conditions are checked.
TEST(ContactPivoting, SolvesProblemsThatThePyramidSolves) {
  int solved = 0;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const double error = first_error(samples::make_solvability(
        Solvability::solvable, seed, 1 + seed % 12, 1, FrictionLaw::pyramid));
    solved += error < INFINITY ? 1 : 0;
    if (error == INFINITY) continue;
    EXPECT_LE(error, 1e-5) << seed;
  }
  EXPECT_GE(solved, 95);
}

/// Positive definite matrices with adhesive springs: every path ends at a solution.
TEST(ContactPivoting, SolvesContactsWithSprings) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    std::mt19937 random(seed);
    const std::int64_t contacts = 1 + seed % 8;
    const std::vector<double> kappa = samples::random_kappa(random, contacts);
    EXPECT_LE(first_error(samples::random_local(random, contacts, 0.3, kappa)), 1e-9) << seed;
  }
}

/// No velocity satisfies all contacts: every path ends in a ray.
TEST(ContactPivoting, EndsWhereThereIsNoSolution) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    const ContactProblem problem =
        samples::make_solvability(Solvability::infeasible, seed, 2 + seed % 6);
    EXPECT_EQ(first_error(problem), INFINITY) << seed;
  }
}

TEST(ContactPivoting, AppliesToSmallProblemsWithThePyramid) {
  const auto of = [](Eigen::Index contacts) {
    return samples::make_solvability(Solvability::solvable, 1, contacts);
  };
  EXPECT_TRUE(FrictionPivoting::applies(of(32), pyramid));
  EXPECT_FALSE(FrictionPivoting::applies(of(33), pyramid));
  EXPECT_FALSE(FrictionPivoting::applies(of(5), {.law = FrictionLaw::cone}));
}

}  // namespace tetwarp::test

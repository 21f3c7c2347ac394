/// @file test_contact_ellipse.cpp
/// Friction with two coefficients per contact: closed forms of a sliding point, equal bits where
/// both are equal, and the reference.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <tetwarp/contact.hpp>
#include <vector>

#include "tests/support/contact/contact_methods.hpp"
#include "tests/support/contact/contact_samples.hpp"
#include "tests/support/message_of.hpp"

namespace tetwarp::test {
namespace {
constexpr double first = 0.6, second = 0.2;  // friction along the tangents

/// A point mass of 2 kg pressed on the plane z = 0 with 3 N s, whose end velocity is (x, y).
ContactProblem sliding_point(double x, double y) {
  const double mass = 2, push = 3;
  const double length = std::hypot(first * x, second * y);
  ContactProblem problem;
  problem.system = {3, 3, {0, 1, 2, 3}, {0, 1, 2}, {mass, mass, mass}};
  problem.jacobian = {3, 3, {0, 1, 2, 3}, {2, 0, 1}, {1, 1, 1}};
  problem.load = {mass * x + push * first * first * x / length,
                  mass * y + push * second * second * y / length, -push};
  problem.velocity_offset = {0, 0, 0};
  problem.friction = {first};
  problem.second_friction = {second};
  return problem;
}

TEST(ContactEllipse, SlidesAgainstTheFrictionOfMostDissipation) {
  for (const ContactMethod method : methods) {
    for (const double angle : {0.0, 0.3, 1.2, 2.5, -0.7, M_PI_2}) {
      const double x = std::cos(angle), y = std::sin(angle);
      const ContactProblem problem = sliding_point(x, y);

      const ContactSolution solution =
          solve_contacts(problem, {.method = method, .tolerance = 1e-12});

      EXPECT_TRUE(solution.converged()) << solution.report.status_reason;
      EXPECT_NEAR(solution.body_velocity[0], x, 1e-10);
      EXPECT_NEAR(solution.body_velocity[1], y, 1e-10);
      const double bound = std::hypot(solution.impulse[1] / first, solution.impulse[2] / second);
      EXPECT_NEAR(bound, solution.impulse[0], 1e-10);
      EXPECT_LE(residual_of(problem, solution.impulse, solution.body_velocity).eta, 1e-11);
    }
  }
}

TEST(ContactEllipse, SticksInsideTheEllipseOnly) {
  for (const double share : {0.99, 1.01}) {
    ContactProblem problem = sliding_point(1, 1);
    // Tangential loads on the ellipse, times `share`.
    problem.load = {share * 3 * first * std::cos(0.4), share * 3 * second * std::sin(0.4), -3};

    const ContactSolution solution = solve_contacts(problem, {.tolerance = 1e-12});

    const double speed = std::hypot(solution.body_velocity[0], solution.body_velocity[1]);
    EXPECT_EQ(speed < 1e-10, share < 1) << share;
  }
}

/// A skate: friction across its edge only.
TEST(ContactEllipse, OneCoefficientMayBeZero) {
  for (const bool is_swapped : {false, true}) {
    ContactProblem problem = sliding_point(1, 1);
    problem.load = {1, 0.5, -3};
    problem.friction = {is_swapped ? 0.0 : first};
    problem.second_friction = {is_swapped ? first : 0.0};
    for (const ContactMethod method : methods) {
      const ContactSolution solution =
          solve_contacts(problem, {.method = method, .tolerance = 1e-12});

      EXPECT_TRUE(solution.converged()) << solution.report.status_reason;
      const double free[] = {0.5, 0.25};
      EXPECT_NEAR(solution.body_velocity[is_swapped ? 1 : 0], 0, 1e-12);
      EXPECT_NEAR(solution.body_velocity[is_swapped ? 0 : 1], free[is_swapped ? 0 : 1], 1e-12);
    }
  }
}

TEST(ContactEllipse, EqualCoefficientsHaveTheBitsOfOne) {
  for (const ContactProblem& plain : {local_problem(71, 9), global_problem(72, 5, 0.3)}) {
    ContactProblem both = plain;
    both.second_friction = both.friction;

    expect_same_bits(solve_contacts(both), solve_contacts(plain), "equal coefficients");
  }
}

/// The pyramid bounds each tangent by its own coefficient.
TEST(ContactEllipse, PyramidIsARectangle) {
  ContactProblem problem = sliding_point(1, 1);
  problem.load = {10, 10, -3};

  const ContactSolution solution =
      solve_contacts(problem, {.law = FrictionLaw::pyramid, .tolerance = 1e-12});

  EXPECT_NEAR(solution.impulse[1], -first * 3, 1e-10);
  EXPECT_NEAR(solution.impulse[2], -second * 3, 1e-10);
}

/// Spring and ellipse side by side: r_t = -K (u_t + o_t) + friction of the ellipse.
TEST(ContactEllipse, ActsBesideTheSpringsOfAnAdhesiveContact) {
  const double kappa = 0.5;
  ContactProblem problem = sliding_point(1, 2);
  problem.adhesion = samples::bond(kappa);
  const double dt = problem.adhesion.time_step;
  problem.adhesion.gap = {0, 0.3 * dt, -0.2 * dt};
  problem.load[0] += kappa * (1 + 0.3);
  problem.load[1] += kappa * (2 - 0.2);

  const ContactSolution solution = solve_contacts(problem, {.tolerance = 1e-12});

  EXPECT_TRUE(solution.converged()) << solution.report.status_reason;
  EXPECT_NEAR(solution.body_velocity[0], 1, 1e-9);
  EXPECT_NEAR(solution.body_velocity[1], 2, 1e-9);
  EXPECT_LE(residual_of(problem, solution).eta, 1e-11);
  EXPECT_NE(message_of([&] {
              solve_contacts(problem, {.rule = AdhesionRule::restrictive});
            }).find("rule restrictive does not define"),
            std::string::npos);
}

TEST(ContactEllipse, AgreesWithTheReference) {
  for (std::uint32_t seed = 0; seed < 12; ++seed) {
    std::mt19937 random(900 + seed);
    const bool is_local = seed % 3 == 0;
    ContactProblem problem = is_local ? samples::random_local(random, 6, 0.3, {}, 10)
                                      : global_problem(800 + seed, 4, seed % 2 * 0.3);
    if (is_local) problem.adhesion = {};
    std::uniform_real_distribution<double> draw(0, 0.5);
    for (std::size_t c = 0; c < problem.friction.size(); ++c) {
      problem.second_friction.push_back(c % 4 == 3 ? problem.friction[c] : draw(random));
    }
    for (const FrictionLaw law : {FrictionLaw::cone, FrictionLaw::pyramid}) {
      const ContactOptions options = {.law = law, .tolerance = 1e-10};
      ContactOptions truth = options;
      truth.backend = Backend::reference;

      const ContactSolution solution = solve_contacts(problem, options);
      const ContactSolution expected = solve_contacts(problem, truth);

      EXPECT_TRUE(solution.converged()) << seed << solution.report.status_reason;
      EXPECT_TRUE(expected.converged()) << seed << expected.report.status_reason;
      for (std::size_t row = 0; row < solution.velocity.size(); ++row) {
        EXPECT_NEAR(solution.velocity[row], expected.velocity[row], 1e-6) << seed << " row " << row;
      }
    }
  }
}

TEST(ContactEllipse, RefusesBadCoefficients) {
  ContactProblem problem = sliding_point(1, 1);
  problem.second_friction = {-0.1};
  EXPECT_NE(
      message_of([&] { check_problem(problem); }).find("second_friction[0]: -0.1 is negative"),
      std::string::npos);
  problem.second_friction = {0.1, 0.2};
  EXPECT_NE(message_of([&] { check_problem(problem); }).find("one per contact"), std::string::npos);
}
}  // namespace
}  // namespace tetwarp::test

/// @file test_contact_rolling.cpp
/// Rolling and torsional friction: closed forms of a sphere on a plane, the reference, methods that
/// refuse it, and bad input.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <tetwarp/contact.hpp>
#include <vector>

#include "tests/support/contact/contact_methods.hpp"
#include "tests/support/contact/contact_rows.hpp"
#include "tests/support/contact/contact_samples.hpp"
#include "tests/support/message_of.hpp"

namespace tetwarp::test {
namespace {
constexpr double sphere_mass = 2, radius = 0.5, inertia = 0.4 * sphere_mass * radius * radius;
constexpr double push = 3;  // N s, of gravity
constexpr ContactMethod capable[] = {ContactMethod::automatic, ContactMethod::gauss_seidel,
                                     ContactMethod::nonlinear_cg, ContactMethod::anderson};

/// A sphere that gravity presses on the plane z = 0 from a velocity [m/s] and a spin [rad/s].
ContactProblem sphere(const Eigen::Vector3d& velocity,
                      const Eigen::Vector3d& spin,
                      double friction,
                      double rolling,
                      double torsion) {
  ContactProblem problem;
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(6, 6);
  system.diagonal() << sphere_mass, sphere_mass, sphere_mass, inertia, inertia, inertia;
  problem.system = samples::sparse_of(system);
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(3, 6);
  jacobian(0, 2) = 1;
  jacobian(1, 0) = 1;
  jacobian(1, 4) = -radius;
  jacobian(2, 1) = 1;
  jacobian(2, 3) = radius;
  problem.jacobian = samples::sparse_of(jacobian);
  problem.load = {
      sphere_mass * velocity[0], sphere_mass * velocity[1], sphere_mass * velocity[2] - push,
      inertia * spin[0],         inertia * spin[1],         inertia * spin[2]};
  problem.velocity_offset = {0, 0, 0};
  problem.friction = {friction};
  problem.rolling.contact = {0};
  problem.rolling.jacobian = {3, 6, {0, 1, 2, 3}, {5, 3, 4}, {1, 1, 1}};
  problem.rolling.rolling = {rolling};
  problem.rolling.torsion = {torsion};
  return problem;
}

ContactSolution solved(const ContactProblem& problem, ContactMethod method) {
  ContactSolution solution = solve_contacts(problem, {.method = method, .tolerance = 1e-12});
  EXPECT_TRUE(solution.converged()) << report_name_of(method) << solution.report.status_reason;
  EXPECT_LE(residual_of(problem, solution).eta, 1e-11);
  EXPECT_EQ(solution.rolling_impulse.size(), 3U);
  EXPECT_EQ(solution.report.rolling_contacts, 1);
  return solution;
}

TEST(ContactRolling, TorsionSlowsASpinningSphere) {
  const double torsion = 0.01, drop = torsion * push / inertia;
  for (const ContactMethod method : capable) {
    for (const double spin : {2.0, -2.0, 0.5 * drop}) {
      const ContactSolution solution =
          solved(sphere({0, 0, 0}, {0, 0, spin}, 0.3, 0, torsion), method);

      const double left = std::copysign(std::max(std::abs(spin) - drop, 0.0), spin);
      EXPECT_NEAR(solution.body_velocity[5], left, 1e-12);
      EXPECT_NEAR(solution.rolling_impulse[0], inertia * (left - spin), 1e-12);
    }
  }
}

TEST(ContactRolling, SlowsASphereOnIceAlongItsSpin) {
  const double rolling = 0.02, drop = rolling * push / inertia;
  for (const ContactMethod method : capable) {
    const ContactSolution solution = solved(sphere({0, 0, 0}, {3, -4, 0}, 0, rolling, 0), method);

    EXPECT_NEAR(solution.body_velocity[3], 3 * (1 - drop / 5), 1e-12);
    EXPECT_NEAR(solution.body_velocity[4], -4 * (1 - drop / 5), 1e-12);
  }
}

/// Without sliding: (I + m R^2) times the change of the spin is the rolling impulse.
TEST(ContactRolling, SlowsARollingSphere) {
  const double rolling = 0.02, spin = 4;
  for (const ContactMethod method : capable) {
    const ContactSolution solution =
        solved(sphere({radius * spin, 0, 0}, {0, spin, 0}, 1, rolling, 0), method);

    const double left = spin - rolling * push / (inertia + sphere_mass * radius * radius);
    EXPECT_NEAR(solution.body_velocity[4], left, 1e-11);
    EXPECT_NEAR(solution.body_velocity[0], radius * left, 1e-11);
    EXPECT_NEAR(solution.rolling_impulse[2], -rolling * push, 1e-11);
  }
}

/// A slope of tangent a holds the sphere up to a = rolling / R.
TEST(ContactRolling, HoldsASphereOnASlope) {
  const double rolling = 0.1;
  for (const ContactMethod method : capable) {
    for (const double share : {0.99, 1.01}) {
      ContactProblem problem = sphere({0, 0, 0}, {0, 0, 0}, 1, rolling, 0);
      problem.load[0] = share * rolling / radius * push;

      const ContactSolution solution = solved(problem, method);

      EXPECT_EQ(solution.body_velocity[0] < 1e-10, share < 1) << share;
    }
  }
}

TEST(ContactRolling, AnOpenContactDoesNotResist) {
  const ContactSolution solution =
      solved(sphere({0, 0, 4}, {1, 2, 3}, 1, 1, 1), ContactMethod::automatic);

  EXPECT_EQ(solution.rolling_impulse, (std::vector<double>{0, 0, 0}));
}

ContactProblem rolling_problem(std::uint32_t seed, double coupling) {
  ContactProblem problem = global_problem(seed, 5, coupling);
  add_rolling_friction(problem, seed);
  return problem;
}

TEST(ContactRolling, AgreesWithTheReference) {
  for (const double coupling : {0.0, 0.3}) {
    for (std::uint32_t seed = 0; seed < 6; ++seed) {
      SCOPED_TRACE(seed);
      expect_reference(rolling_problem(40 + seed, coupling), capable, 1e-5);
    }
  }
}

TEST(ContactRolling, CoupledBodiesMayBeIterated) {
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE(seed);
    expect_iteration(rolling_problem(60 + seed, 0.3));
  }
}

TEST(ContactRolling, StartsFromItsGuessInFloat32AndInSeries) {
  ContactProblem problem = rolling_problem(70, 0);
  ContactSolver solver({.tolerance = 1e-9, .threads = 1});
  const ContactSolution solution = solver.solve(problem);
  expect_same_bits(solver.solve(problem), solution, "again");
  expect_same_bits(solve_contacts(problem, {.tolerance = 1e-9, .threads = 3}), solution, "threads");
  EXPECT_TRUE(solve_contacts(problem, {.precision = ContactPrecision::float32}).converged());

  problem.impulse_guess = solution.impulse;
  problem.rolling.impulse_guess = solution.rolling_impulse;
  EXPECT_EQ(solve_contacts(problem, {.tolerance = 1e-8}).report.sweeps, 0);
}

TEST(ContactRolling, NewtonsMethodRefusesIt) {
  const std::string message = message_of(
      [&] { solve_contacts(rolling_problem(71, 0), {.method = ContactMethod::newton}); });

  EXPECT_NE(message.find("has no rolling friction; choose automatic"), std::string::npos)
      << message;
}

TEST(ContactRolling, IsRefusedInOneLine) {
  const struct {
    void (*spoil)(ContactProblem&);
    const char* text;
  } cases[] = {
      {[](ContactProblem& p) { p.rolling.rolling = {-1}; }, "rolling.rolling[0]: -1 is negative"},
      {[](ContactProblem& p) { p.rolling.torsion = {NAN}; },
       "rolling.torsion[0]: nan is not finite"},
      {[](ContactProblem& p) { p.rolling.torsion = {}; }, "rolling.torsion: 0 entries, expected 1"},
      {[](ContactProblem& p) { p.rolling.contact = {1}; },
       "rolling.contact[0]: 1, expected 0 to 0"},
      {[](ContactProblem& p) { p.rolling.jacobian.rows = 4; }, "rolling.jacobian"},
      {[](ContactProblem& p) {
         p.rolling.jacobian.value = {0, 0, 0};
       },
       "act on no body of contact 0"}};
  for (const auto& [spoil, text] : cases) {
    ContactProblem problem = sphere({0, 0, 0}, {0, 0, 0}, 1, 1, 1);
    spoil(problem);

    const std::string message = message_of([&] { check_problem(problem); });

    EXPECT_NE(message.find(text), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
}
}  // namespace
}  // namespace tetwarp::test

/// @file test_contact_analysis.cpp
/// contact_modes() and energy_balance(): closed forms of a block, and the balance of random
/// problems with everything that has energy.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <tetwarp/contact_analysis.hpp>
#include <vector>

#include "tests/support/contact/contact_methods.hpp"
#include "tests/support/contact/contact_samples.hpp"
#include "tests/support/message_of.hpp"

namespace tetwarp::test {
namespace {
constexpr double mass = 2, gravity = 9.81, dt = 0.01, friction = 0.3;

/// A block, as a point mass, on the plane z = 0.
ContactProblem block(const Eigen::Vector3d& velocity) {
  ContactProblem problem;
  problem.system = {3, 3, {0, 1, 2, 3}, {0, 1, 2}, {mass, mass, mass}};
  problem.jacobian = {3, 3, {0, 1, 2, 3}, {2, 0, 1}, {1, 1, 1}};
  problem.load = {mass * velocity[0], mass * velocity[1], mass * (velocity[2] - gravity * dt)};
  problem.velocity_offset = {0, 0, 0};
  problem.friction = {friction};
  return problem;
}

ContactMode mode_of(const ContactProblem& problem, const ContactOptions& options = {}) {
  return contact_modes(problem, solve_contacts(problem, options), options).mode.at(0);
}

TEST(ContactAnalysis, NamesTheModeOfAContact) {
  EXPECT_EQ(mode_of(block({1, 0, 0})), ContactMode::slide);
  EXPECT_EQ(mode_of(block({0.001, 0, 0})), ContactMode::stick);
  EXPECT_EQ(mode_of(block({0, 0, 1})), ContactMode::open);
  ContactProblem ice = block({0.001, 0, 0});
  ice.friction = {0};
  EXPECT_EQ(mode_of(ice), ContactMode::slide);
  ContactProblem held = block({0, 0, 1});
  held.adhesion = samples::bond(0.1);
  EXPECT_EQ(mode_of(held), ContactMode::adhering);
  ContactProblem ellipse = block({0.02, 0, 0});
  ellipse.second_friction = {0.01};
  EXPECT_EQ(mode_of(ellipse), ContactMode::stick);
  ellipse.load = {0, mass * 0.02, ellipse.load[2]};
  EXPECT_EQ(mode_of(ellipse), ContactMode::slide);
}

TEST(ContactAnalysis, ResidualsOfContactsAreSharesOfEta) {
  const ContactProblem problem = global_problem(77, 5, 0.3);
  ContactSolution solution = solve_contacts(problem, {.tolerance = 1e-9});
  for (double& r : solution.impulse) r *= 1.01;
  solution.body_velocity.clear();

  const ContactModes modes = contact_modes(problem, solution);

  double sum = 0;
  for (const double residual : modes.residual) sum += residual * residual;
  const ContactResidual residual = residual_of(problem, solution);
  EXPECT_GT(residual.eta, 1e-4);
  EXPECT_NEAR(std::sqrt(sum), residual.eta, 1e-12);
  EXPECT_EQ(modes.residual[static_cast<std::size_t>(residual.largest_contact)], residual.largest);
}

/// Friction takes mu N dt |u|, the floor what gravity would have accelerated.
TEST(ContactAnalysis, ASlidingBlockLosesItsFriction) {
  const ContactProblem problem = block({1, 0, 0});
  const ContactSolution solution = solve_contacts(problem, {.tolerance = 1e-13});
  const std::vector<double> start = {1, 0, 0};

  const EnergyBalance energy = energy_balance(problem, solution, start);

  const double end = 1 - friction * gravity * dt, fall = gravity * dt;
  EXPECT_NEAR(energy.friction_loss, friction * mass * gravity * dt * end, 1e-13);
  EXPECT_NEAR(energy.before, mass / 2, 1e-14);
  EXPECT_NEAR(energy.after, mass * end * end / 2, 1e-13);
  EXPECT_NEAR(energy.load_work, mass * fall * fall / 2, 1e-13);
  EXPECT_NEAR(energy.impact_loss, mass * (fall * fall + (1 - end) * (1 - end)) / 2, 1e-13);
  EXPECT_EQ(energy.offset_work, 0);
  EXPECT_NEAR(energy.error, 0, 1e-14);
}

/// A ball that comes with v and leaves with e v: w_n = -e v.
TEST(ContactAnalysis, RestitutionGivesEnergyBack) {
  ContactProblem problem = block({0, 0, -2});
  problem.load[2] = mass * -2;
  problem.velocity_offset[0] = -0.5 * 2;
  const EnergyBalance energy =
      energy_balance(problem, solve_contacts(problem, {.tolerance = 1e-13}));

  EXPECT_NEAR(energy.after, mass * 1.0 / 2, 1e-12);
  EXPECT_NEAR(energy.offset_work, mass * 3 * 1, 1e-12);  // r = 3 m, w = -1
  EXPECT_NEAR(energy.impact_loss, mass * 9.0 / 2, 1e-12);
  EXPECT_NEAR(energy.error, 0, 1e-13);
}

/// The spring takes 1/2 kappa u^2 and loses as much to its implicit step.
TEST(ContactAnalysis, AStretchedBondStoresEnergy) {
  ContactProblem problem = block({0, 0, 1});
  problem.load[2] = mass * 1;
  problem.adhesion = samples::bond(3);
  const EnergyBalance energy =
      energy_balance(problem, solve_contacts(problem, {.tolerance = 1e-13}));

  const double u = mass / (mass + 3);  // m u = m - kappa u
  EXPECT_NEAR(energy.adhesion_after, 3 * u * u / 2, 1e-13);
  EXPECT_NEAR(energy.adhesion_loss, 3 * u * u / 2, 1e-13);
  EXPECT_EQ(energy.adhesion_before, 0);
  EXPECT_NEAR(energy.error, 0, 1e-14);
}

TEST(ContactAnalysis, EnergyBalancesToRounding) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    ContactProblem problem = global_problem(3000 + seed, 5, seed % 2 * 0.3);
    std::mt19937 random(seed);
    const auto dofs = static_cast<Eigen::Index>(problem.dof_count());
    const auto draw = [&](Eigen::Index size) {
      return samples::list_of(samples::random_vector(random, size));
    };
    problem.velocity_offset = draw(3 * static_cast<Eigen::Index>(problem.contact_count()));
    if (seed % 3 > 0) {
      Eigen::MatrixXd rows(2, dofs);
      for (Eigen::Index row = 0; row < 2; ++row)
        rows.row(row) = samples::random_vector(random, dofs);
      problem.bilateral.jacobian = samples::sparse_of(rows);
      problem.bilateral.target = draw(2);
      problem.bilateral.compliance = {0, 0.2};
    }
    if (seed % 3 > 1) {
      problem.second_friction.assign(problem.friction.size(), 0.1);
      Eigen::MatrixXd rows(3, dofs);
      for (Eigen::Index row = 0; row < 3; ++row)
        rows.row(row) = samples::random_vector(random, dofs);
      problem.rolling = {{1}, samples::sparse_of(rows), {0.1}, {0.2}, {}};
    }
    // The balance holds for any iterate, also a bad one.
    for (const double tolerance : {1e-1, 1e-10}) {
      const ContactSolution solution = solve_contacts(problem, {.tolerance = tolerance});
      const std::vector<double> start = draw(dofs);

      const EnergyBalance energy = energy_balance(problem, solution, start);

      EXPECT_LE(std::abs(energy.error), 1e-11 * (energy.free + energy.after + energy.impact_loss));
      EXPECT_NEAR(energy.before + energy.load_work, energy.free, 1e-12 * energy.free);
      if (tolerance > 1e-9 || !solution.converged()) continue;
      EXPECT_GE(energy.friction_loss, -1e-8 * energy.free);
      EXPECT_GE(energy.rolling_loss, -1e-8 * energy.free);
      EXPECT_GE(energy.adhesion_loss, 0);
    }
  }
}

TEST(ContactAnalysis, NamesWhatItCannotUse) {
  const ContactProblem local = local_problem(78, 2);
  EXPECT_NE(message_of([&] { energy_balance(local, solve_contacts(local)); }).find("local form"),
            std::string::npos);
  const ContactProblem problem = block({1, 0, 0});
  EXPECT_NE(message_of([&] { energy_balance(problem, {}); }).find("body_velocity: 0 entries"),
            std::string::npos);
  EXPECT_NE(message_of([&] { contact_modes(problem, {}); }).find("impulse: 0 entries"),
            std::string::npos);
}
}  // namespace
}  // namespace tetwarp::test

/// @file contact_rows.hpp
/// Rows beyond those of contacts for seeded problems of bodies of six dofs; see global_problem().
#pragma once
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/contact.hpp>

#include "tests/support/contact/contact_methods.hpp"
#include "tests/support/contact/contact_samples.hpp"

namespace tetwarp::test {

/// Joints, springs and motors in groups of one to three rows, between the first three pairs of
/// bodies.
/// @pre five bodies or more
inline void add_bilateral_rows(ContactProblem& problem, std::uint32_t seed) {
  std::mt19937 random(seed);
  const Eigen::Index rows = 6, dofs = static_cast<Eigen::Index>(problem.dof_count());
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(rows, dofs);
  for (Eigen::Index row = 0; row < rows; ++row) {
    const Eigen::Index body = row < 3 ? 0 : row < 5 ? 2 : 3;
    jacobian.row(row).segment(6 * body, 12) = samples::random_vector(random, 12);
  }
  problem.bilateral.jacobian = samples::sparse_of(jacobian);
  problem.bilateral.group_start = {0, 3, 5, 6};
  problem.bilateral.target = samples::list_of(samples::random_vector(random, rows));
  problem.bilateral.compliance = {0, 0, 0.1, 0, 1e-4, 3};
}

/// Rolling friction on every second contact, about random axes of its first body.
inline void add_rolling_friction(ContactProblem& problem, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> draw(0, 0.4);
  RollingFriction& rolling = problem.rolling;
  const std::int64_t entries = (problem.contact_count() + 1) / 2;
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(3 * entries, problem.dof_count());
  for (std::int32_t k = 0; k < entries; ++k) {
    const std::int64_t first = problem.jacobian.row_start[static_cast<std::size_t>(6 * k)];
    const Eigen::Index body = problem.jacobian.column[static_cast<std::size_t>(first)] / 6;
    for (int a = 0; a < 3; ++a) {
      jacobian.row(3 * k + a).segment(6 * body, 6) = samples::random_vector(random, 6);
    }
    rolling.contact.push_back(2 * k);
    rolling.rolling.push_back(draw(random));
    rolling.torsion.push_back(draw(random));
  }
  rolling.jacobian = samples::sparse_of(jacobian);
}

/// Half as much friction along tangent 2.
inline void add_ellipses(ContactProblem& problem) {
  problem.second_friction = problem.friction;
  for (double& friction : problem.second_friction) friction /= 2;
}

/// Expects that every method solves a problem to 1e-10, to the velocities of the reference.
/// @param tolerance  of the velocities
inline void expect_reference(const ContactProblem& problem,
                             std::span<const ContactMethod> methods,
                             double tolerance) {
  const ContactSolution expected = solve_contacts(problem, {.backend = Backend::reference});
  EXPECT_TRUE(expected.converged()) << expected.report.status_reason;
  for (const ContactMethod method : methods) {
    const ContactOptions options = {.method = method, .tolerance = 1e-10};
    const ContactSolution solution = solve_contacts(problem, options);

    const std::string what = report_name_of(method);
    EXPECT_TRUE(solution.converged()) << what << solution.report.status_reason;
    EXPECT_LE(residual_of(problem, solution, options).eta, 1.001e-10) << what;
    for (std::size_t i = 0; i < solution.body_velocity.size(); ++i) {
      EXPECT_NEAR(solution.body_velocity[i], expected.body_velocity[i], tolerance) << what;
    }
  }
}

/// Expects that the outer iteration solves a problem of coupled bodies, whose residual it bounds.
inline void expect_iteration(const ContactProblem& problem) {
  const ContactSolution solution = solve_contacts(
      problem,
      {.tolerance = 1e-6, .expert = {.coupling = ContactCoupling::iterated, .relaxation = 0.3}});

  EXPECT_TRUE(solution.converged()) << solution.report.status_reason;
  EXPECT_LE(residual_of(problem, solution).eta, 1e-6);
}

}  // namespace tetwarp::test

/// @file test_contact_multipliers.cpp
/// The method of multipliers: its projection, its dense bodies, and the problems that it solves.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact/newton/augmented_lagrangian.hpp"
#include "host/contact/newton/dense_bodies.hpp"
#include "host/contact/problem/delassus.hpp"
#include "host/contact/problem/friction_cone.hpp"
#include "host/contact/problem/measure.hpp"
#include "tests/support/contact/contact_scenes.hpp"

namespace tetwarp::test {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

VectorXd random_numbers(std::mt19937& random, Index size) {
  std::normal_distribution<double> normal;
  return VectorXd::NullaryExpr(size, [&] { return normal(random); });
}

/// Law: x - P(x) is in the polar cone and orthogonal to P(x), which is in the cone; the derivative
/// is that of differences.
TEST(ContactMultipliers, ProjectionIsTheNearestPointOfTheCone) {
  std::mt19937 random(1);
  for (const double friction : {0.0, 0.1, 0.5, 1.0, 3.0}) {
    for (int k = 0; k < 200; ++k) {
      const Vector3d x = random_numbers(random, 3), way = random_numbers(random, 3);
      Matrix3d derivative;
      const Vector3d p = project_on_cone(x, friction, &derivative), left = x - p;

      EXPECT_LE(p.tail<2>().norm(), friction * p(0) + 1e-15);
      EXPECT_LE(friction * left.tail<2>().norm(), -left(0) + 1e-14);
      EXPECT_NEAR(p.dot(left), 0, 1e-14);
      constexpr double step = 1e-6;
      const Vector3d change =
          project_on_cone(x + step * way, friction) - project_on_cone(x - step * way, friction);
      EXPECT_LT((change / (2 * step) - derivative * way).norm(), 1e-5 * way.norm()) << friction;
    }
  }
}

/// Law: dense bodies are those of the sparse factorization.
TEST(ContactMultipliers, DenseBodiesAreThoseOfTheProblem) {
  std::mt19937 random(2);
  const ContactProblem problem = scenes::box_stack({.mass_ratio = 1e2, .friction = 0.5});
  const DenseBodies bodies(problem, 1e9);
  const Delassus delassus(problem, 1e9);
  const VectorXd impulse = random_numbers(random, 3 * problem.contact_count());
  VectorXd push = bodies.load();
  for (std::size_t c = 0; c < problem.friction.size(); ++c) {
    bodies.add_push(c, impulse.segment<3>(3 * static_cast<Index>(c)), push);
  }
  const VectorXd velocity = bodies.solve(push);

  EXPECT_LT((velocity - delassus.body_velocity(impulse)).norm(), 1e-12 * velocity.norm());
  const std::vector<Matrix3d> blocks = delassus.diagonal_blocks();
  const VectorXd u = delassus.contact_velocity(velocity);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(problem.dof_count(), problem.dof_count());
  for (std::size_t c = 0; c < problem.friction.size(); ++c) {
    EXPECT_LT((bodies.diagonal_block(c) - blocks[c]).norm(), 1e-12 * blocks[c].norm());
    EXPECT_LT(
        (bodies.contact_velocity(c, velocity) - u.segment<3>(3 * static_cast<Index>(c))).norm(),
        1e-12 * u.norm());
    const Matrix3d response = Vector3d(1, 2, 3).asDiagonal();
    bodies.add_response(c, response, sum);
    const Vector3d own = bodies.contact_velocity(c, velocity) -
                         bodies.contact_velocity(c, VectorXd::Zero(velocity.size()));
    VectorXd expected = VectorXd::Zero(velocity.size());
    bodies.add_push(c, response * own, expected);
    EXPECT_LT((sum.selfadjointView<Eigen::Lower>() * velocity - expected).norm(),
              1e-12 * expected.norm());
    sum.setZero();
  }
}

/// Error of zero impulses [sqrt(J)], part of the scale of eta.
double free_error(const ContactProblem& problem, const Delassus& delassus) {
  std::vector<MeasuredContact> contacts = measured_contacts(problem);
  const std::vector<Matrix3d> blocks = delassus.diagonal_blocks();
  double sum = 0;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    contacts[c].diagonal_block = blocks[c];
    sum += natural_energy(contacts[c], Vector3d::Zero(),
                          delassus.free_velocity().segment<3>(3 * static_cast<Index>(c)),
                          FrictionLaw::cone, AdhesionRule::parallel);
  }
  return std::sqrt(sum);
}

/// After 24 sweeps, on stacks whose masses grow upward to a factor of 243, half of them glued: it
/// solves most of them, those without friction all, and what it calls solved has a residual, found
/// by a sparse factorization, within the tolerance.
TEST(ContactMultipliers, SolvesSmallStacksAfterFewSweeps) {
  int solved = 0;
  for (const double ratio : {1e-2, 1.0, 1e2, 243.0}) {
    for (const double friction : {0.0, 0.2, 0.8}) {
      for (const bool is_glued : {false, true}) {
        SCOPED_TRACE(testing::Message() << ratio << " " << friction << " " << is_glued);
        scenes::BoxStack choice{.boxes = 6, .mass_ratio = ratio, .friction = friction};
        if (is_glued) choice.glue = {.stiffness = 1e6};
        ContactProblem problem = scenes::box_stack(choice);
        // Springs of some contacts hold along the tangents only.
        for (std::size_t c = 0; c < problem.adhesion.stiffness.size(); c += 3) {
          problem.adhesion.stiffness[c] = 0;
        }
        const ContactOptions options{.tolerance = 1e-5};
        const Delassus delassus(problem, options.recovery_speed);
        const StopCriterion criterion{options.measure, options.tolerance,
                                      options.tolerance * free_error(problem, delassus)};
        std::vector<double> impulse =
            solve_contacts(problem, {.method = ContactMethod::anderson, .max_sweeps = 24}).impulse;
        ASSERT_TRUE(takes_multipliers(problem, options, problem.dof_count()));

        const NewtonResult result =
            solve_by_multipliers(problem, options, criterion, impulse, nullptr);

        solved += result.converged ? 1 : 0;
        EXPECT_TRUE(result.converged || friction > 0);
        if (!result.converged) continue;
        const VectorXd v =
            delassus.body_velocity(Eigen::Map<const VectorXd>(impulse.data(), std::ssize(impulse)));
        EXPECT_LE(
            residual_of(problem, impulse, std::vector<double>(v.begin(), v.end()), options).eta,
            1.01 * options.tolerance);
      }
    }
  }
  EXPECT_GE(solved, 17) << "of 24";
}

/// What automatic does with a stack whose sweeps are slow, against Newton's method.
TEST(ContactMultipliers, AutomaticTakesThemForHeavyStacks) {
  const ContactProblem problem =
      scenes::box_stack({.boxes = 6, .mass_ratio = 243, .friction = 0.5});
  const ContactSolution solution = solve_contacts(problem, {.tolerance = 1e-6});

  EXPECT_TRUE(solution.converged());
  EXPECT_NE(solution.report.method.find("multipliers"), std::string::npos)
      << solution.report.method;
  EXPECT_LE(solution.report.sweeps, 100);
  const ContactSolution truth =
      solve_contacts(problem, {.method = ContactMethod::newton, .tolerance = 1e-10});
  ASSERT_TRUE(truth.converged());
  double difference = 0;
  for (std::size_t d = 0; d < truth.body_velocity.size(); ++d) {
    difference = std::max(difference, std::abs(solution.body_velocity[d] - truth.body_velocity[d]));
  }
  const Delassus delassus(problem, 1e9);
  const double size = delassus.free_velocity().lpNorm<Eigen::Infinity>();
  EXPECT_LT(difference, 1e-3 * size);
}

/// Problems of other forms and laws are left to the other methods.
TEST(ContactMultipliers, OtherProblemsAreNotTaken) {
  const ContactProblem problem = scenes::box_stack({.mass_ratio = 1, .friction = 0.5});
  const std::int64_t dofs = problem.dof_count();
  EXPECT_TRUE(takes_multipliers(problem, {}, dofs));
  EXPECT_FALSE(takes_multipliers(problem, {}, 1000));
  EXPECT_FALSE(takes_multipliers(problem, {.max_newton = 0}, dofs));
  EXPECT_FALSE(takes_multipliers(problem, {.law = FrictionLaw::pyramid}, dofs));
  EXPECT_FALSE(takes_multipliers(problem, {.rule = AdhesionRule::restrictive}, dofs));
  EXPECT_FALSE(takes_multipliers(problem, {.measure = ContactMeasure::fclib}, dofs));
  EXPECT_FALSE(takes_multipliers(scenes::random_local({}), {}, 0));
  ContactProblem jointed = problem;
  scenes::add_ball_joints(jointed, 2, 0.05);
  const ContactSolution solution = solve_contacts(jointed, {.tolerance = 1e-8});
  EXPECT_TRUE(solution.converged());
  EXPECT_EQ(solution.report.multiplier_steps, 0);
}
}  // namespace
}  // namespace tetwarp::test

/// @file test_contact_reference.cpp
/// Back end reference of the contact solver, against enumeration, the laws and closed forms.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/reference/contact/contact.hpp"
#include "host/reference/contact/dense.hpp"
#include "host/reference/contact/enumerate.hpp"
#include "host/reference/contact/feasible.hpp"
#include "host/reference/contact/gauss_seidel.hpp"
#include "tests/support/contact/contact_samples.hpp"

namespace tetwarp {
namespace {
using Eigen::Index;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using reference::DenseContacts;
using samples::vector_of;

constexpr AdhesionRule rules[] = {AdhesionRule::parallel, AdhesionRule::restrictive};
constexpr FrictionLaw laws[] = {FrictionLaw::cone, FrictionLaw::pyramid};

VectorXd zeros(const DenseContacts& contacts) {
  return VectorXd::Zero(contacts.free_velocity.size());
}

/// Largest violation of a condition of the contact laws, in m/s, N s or J.
double breach(const ContactProblem& problem,
              const ContactSolution& solution,
              const ContactOptions& options) {
  const DenseContacts contacts = reference::make_dense(problem);
  const VectorXd r = vector_of(solution.impulse);
  const VectorXd u = vector_of(solution.velocity);
  const VectorXd spring = contacts.stiffness.cwiseProduct(u + contacts.offset);
  const VectorXd nu = r + spring;
  const double chi = options.rule == AdhesionRule::restrictive ? 1 : 0;
  double largest = (contacts.delassus * r + contacts.free_velocity - u).norm();
  for (Index row = 0; row < r.size(); row += 3) {
    const double coulomb = problem.friction[static_cast<std::size_t>(row / 3)] * nu(row);
    largest = std::max({largest, -nu(row), -u(row), std::abs(nu(row) * u(row))});
    const Vector2d f = nu.segment<2>(row + 1);
    const Vector2d slip = u.segment<2>(row + 1);
    const Vector2d pull = spring.segment<2>(row + 1);
    if (options.law == FrictionLaw::cone) {
      const double bound = std::max(coulomb - chi * pull.norm(), 0.0);
      largest = std::max({largest, f.norm() - bound, std::abs(f.dot(slip) + bound * slip.norm())});
    }
    for (Index a = 0; a < 2 && options.law == FrictionLaw::pyramid; ++a) {
      const double bound = std::max(coulomb - chi * std::abs(pull(a)), 0.0);
      largest = std::max(
          {largest, std::abs(f(a)) - bound, std::abs(f(a) * slip(a) + bound * std::abs(slip(a)))});
    }
  }
  return largest;
}

TEST(ContactEnumeration, FindsTheOneSolutionOfNormalAdhesionThatSweepsFind) {
  std::mt19937 random(21);
  for (int trial = 0; trial < 40; ++trial) {
    const std::int64_t count = 1 + trial % 8;
    const DenseContacts contacts = reference::make_dense(samples::random_local(
        random, count, 0, samples::random_kappa(random, count), trial % 2 == 0 ? 10 : 1000));

    const std::vector<VectorXd> solutions = reference::enumerate_impulses(contacts, {});
    const VectorXd swept = reference::gauss_seidel(contacts, {}, zeros(contacts)).impulse;

    EXPECT_EQ(reference::mode_count(contacts, {}), std::pow(2.0, count));
    ASSERT_EQ(solutions.size(), 1u) << "trial " << trial;
    EXPECT_LE((solutions[0] - swept).norm(), 1e-9 * swept.norm()) << "trial " << trial;
  }
}

struct Pyramid {
  AdhesionRule rule;
  std::int64_t contacts;
  double modes;
  int trials;
};

class PyramidEnumeration : public testing::TestWithParam<Pyramid> {};

TEST_P(PyramidEnumeration, FindsTheOneSolutionThatSweepsFind) {
  std::mt19937 random(22);
  const ContactOptions options{.law = FrictionLaw::pyramid, .rule = GetParam().rule};
  for (int trial = 0; trial < GetParam().trials; ++trial) {
    std::vector<double> kappa = samples::random_kappa(random, GetParam().contacts);
    for (double& value : kappa) value = std::max(value, 1e-3);
    const DenseContacts contacts =
        reference::make_dense(samples::random_local(random, GetParam().contacts, 0.3, kappa, 10));

    const std::vector<VectorXd> solutions = reference::enumerate_impulses(contacts, options);
    const VectorXd swept = reference::gauss_seidel(contacts, options, zeros(contacts)).impulse;

    EXPECT_EQ(reference::mode_count(contacts, options), GetParam().modes);
    ASSERT_EQ(solutions.size(), 1u) << "trial " << trial;
    EXPECT_LE((solutions[0] - swept).norm(), 1e-9 * swept.norm()) << "trial " << trial;
  }
}

INSTANTIATE_TEST_SUITE_P(Of,
                         PyramidEnumeration,
                         testing::Values(Pyramid{AdhesionRule::parallel, 1, 10, 20},
                                         Pyramid{AdhesionRule::parallel, 2, 100, 30},
                                         Pyramid{AdhesionRule::parallel, 3, 1000, 6},
                                         Pyramid{AdhesionRule::restrictive, 1, 37, 20},
                                         Pyramid{AdhesionRule::restrictive, 2, 1369, 15}));

TEST(ContactEnumeration, LeavesTheConeToTheSweeps) {
  std::mt19937 random(23);
  const ContactProblem problem = samples::random_local(random, 2, 0.3, {1, 1});

  EXPECT_TRUE(std::isinf(reference::mode_count(reference::make_dense(problem), {})));
  EXPECT_EQ(solve_contacts_reference(problem).report.method, "gauss-seidel");
  EXPECT_EQ(solve_contacts_reference(problem, {.law = FrictionLaw::pyramid}).report.method,
            "enumeration");
}

TEST(ContactReference, ObeysEveryLawOnRandomProblems) {
  std::mt19937 random(24);
  for (int trial = 0; trial < 12; ++trial) {
    const std::int64_t count = 1 + trial % 6;
    const ContactProblem problem = samples::random_local(random, count, 0.1 * (trial % 5),
                                                         samples::random_kappa(random, count));
    for (const FrictionLaw law : laws) {
      for (const AdhesionRule rule : rules) {
        const ContactOptions options{.law = law, .rule = rule, .tolerance = 1e-11};
        const ContactSolution solution = solve_contacts_reference(problem, options);
        EXPECT_TRUE(solution.converged()) << solution.report.residual.eta;
        EXPECT_LE(breach(problem, solution, options), 1e-9) << "trial " << trial;
      }
    }
  }
}

TEST(ContactReference, MeasuresTheResidualThatResidualOfMeasures) {
  std::mt19937 random(25);
  for (int trial = 0; trial < 10; ++trial) {
    const ContactProblem problem =
        samples::random_local(random, 5, 0.4, samples::random_kappa(random, 5));
    const VectorXd impulse = samples::random_vector(random, 15);
    for (const FrictionLaw law : laws) {
      for (const AdhesionRule rule : rules) {
        const ContactOptions options{.law = law, .rule = rule};
        const double eta = reference::eta_of(reference::make_dense(problem), impulse, options);
        EXPECT_NEAR(residual_of(problem, samples::list_of(impulse), {}, options).eta, eta,
                    1e-12 * eta);
      }
    }
  }
}

TEST(ContactReference, ConeHasNoPreferredTangents) {
  std::mt19937 random(26);
  ContactProblem problem = samples::random_local(random, 3, 0.5, {0.5, 0, 2});
  const VectorXd before = vector_of(solve_contacts_reference(problem).impulse);
  Eigen::MatrixXd turn = Eigen::MatrixXd::Identity(9, 9);
  for (Index c = 0; c < 3; ++c) {
    turn.block<2, 2>(3 * c + 1, 3 * c + 1) =
        Eigen::Rotation2Dd(0.7 + static_cast<double>(c)).toRotationMatrix();
  }
  const DenseContacts contacts = reference::make_dense(problem);
  problem.delassus = samples::sparse_of(turn * contacts.delassus * turn.transpose());
  problem.free_velocity = samples::list_of(turn * contacts.free_velocity);
  problem.adhesion.gap = samples::list_of(turn * vector_of(problem.adhesion.gap));

  const VectorXd after = vector_of(solve_contacts_reference(problem).impulse);

  EXPECT_LE((after - turn * before).norm(), 1e-10 * before.norm());
}

TEST(ContactReference, GivesBodiesTheVelocityOfTheirImpulses) {
  std::mt19937 random(27);
  for (const double coupling : {0.0, 0.5}) {
    const ContactProblem problem = samples::random_global(random, 4, 6, coupling, 0.3);

    const ContactSolution solution = solve_contacts_reference(problem);

    EXPECT_TRUE(solution.converged());
    EXPECT_LE(solution.report.residual.eta, 1e-11);
    EXPECT_LE(solution.report.residual.balance, 1e-14);
    EXPECT_EQ(solution.body_velocity.size(), 24u);
  }
}

TEST(ContactReference, MovesBodiesWithoutContactsFreely) {
  ContactProblem problem;
  problem.system = samples::sparse_of(4 * Eigen::Matrix3d::Identity());
  problem.load = {4, 8, 12};

  const ContactSolution solution = solve_contacts_reference(problem);

  EXPECT_TRUE(solution.converged());
  EXPECT_EQ(solution.body_velocity, (std::vector<double>{1, 2, 3}));
  EXPECT_TRUE(solution.impulse.empty());
}

TEST(ContactReference, StartsFromTheGuess) {
  std::mt19937 random(28);
  ContactProblem problem = samples::random_local(random, 6, 0.5, {0, 1, 0, 2, 0, 3});
  const ContactSolution cold = solve_contacts_reference(problem);
  problem.impulse_guess = cold.impulse;

  const ContactSolution warm = solve_contacts_reference(problem);

  EXPECT_GT(cold.report.sweeps, 0);
  EXPECT_EQ(warm.report.sweeps, 0);
  EXPECT_EQ(warm.impulse, cold.impulse);
}

TEST(ContactReference, ReturnsTheBestIterateWhereSweepsRunOut) {
  std::mt19937 random(29);
  const ContactProblem problem = samples::random_local(random, 8, 0.5, {}, 1000);

  const ContactSolution solution = solve_contacts_reference(problem, {.max_sweeps = 5});

  const std::vector<double>& history = solution.report.residual_history;
  EXPECT_EQ(solution.report.status, ContactStatus::not_converged);
  EXPECT_NE(solution.report.status_reason, "");
  EXPECT_EQ(solution.report.sweeps, 5);
  EXPECT_NEAR(solution.report.residual.eta, *std::min_element(history.begin(), history.end()),
              1e-12);
}

/// A point between two walls.
/// @param gap  distance of the walls minus the thickness of the point, per dt [m/s]
ContactProblem point_between_walls(double gap, double friction) {
  ContactProblem problem;
  problem.system = samples::sparse_of(Eigen::Matrix3d::Identity());
  Eigen::MatrixXd jacobian(6, 3);
  jacobian << Eigen::Matrix3d::Identity(), -Eigen::Matrix3d::Identity();
  problem.jacobian = samples::sparse_of(jacobian);
  problem.load = {3, 1, 0};
  problem.velocity_offset = {-1, 0, 0, 1 + gap, 0, 0};
  problem.friction = {friction, friction};
  return problem;
}

TEST(ContactReference, StaysPutWhereNoVelocityFits) {
  for (const FrictionLaw law : laws) {
    const ContactSolution solution =
        solve_contacts_reference(point_between_walls(-2, 0), {.law = law, .max_sweeps = 100});

    EXPECT_EQ(solution.report.status, ContactStatus::infeasible);
    EXPECT_NEAR(solution.body_velocity[0], 0, 1e-12);
    EXPECT_NEAR(solution.body_velocity[1], 1, 1e-12);
    EXPECT_NEAR(solution.report.residual.penetration, 1, 1e-12);
    EXPECT_GT(solution.report.residual.eta, 0.1);
  }
}

TEST(ContactReference, FindsTheOneVelocityThatFits) {
  const ContactSolution solution = solve_contacts_reference(point_between_walls(0, 0.25));

  EXPECT_TRUE(solution.converged());
  EXPECT_NEAR(solution.body_velocity[0], 1, 1e-12);
}

TEST(ContactFeasible, SeparatesSqueezedFromLooseContactsInAnyUnits) {
  for (const double unit : {1e-6, 1.0, 1e6}) {
    for (const double gap : {-1.0, -1e-3, 0.0, 1e-3}) {
      ContactProblem problem = point_between_walls(gap, 0.5);
      for (double& value : problem.system.value) value *= unit;
      for (double& value : problem.load) value *= unit * unit;
      for (double& value : problem.velocity_offset) value *= unit;
      EXPECT_EQ(reference::is_feasible(reference::make_dense(problem)), gap >= 0)
          << "gap " << gap << ", unit " << unit;
    }
  }
}

TEST(ContactFeasible, HoldsForContactsThatDoNotDependOnEachOther) {
  std::mt19937 random(30);
  for (int trial = 0; trial < 20; ++trial) {
    const ContactProblem problem = samples::random_local(random, 12, 0.5, {}, 1000);
    EXPECT_TRUE(reference::is_feasible(reference::make_dense(problem)));
  }
}

TEST(ContactReference, RefusesWhatCheckRefuses) {
  EXPECT_THROW(solve_contacts_reference(samples::single_contact({-1, 0, 0}, -0.5)),
               ContactProblemError);
}
}  // namespace
}  // namespace tetwarp

/// @file test_contact_residual.cpp
/// residual_of(): zero where the laws hold, elsewhere the values computed by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <tetwarp/contact.hpp>

#include "host/contact/problem/delassus.hpp"
#include "host/contact/problem/measure.hpp"
#include "tests/support/contact/contact_samples.hpp"

namespace tetwarp {
namespace {
using samples::bond;
using samples::list_of;
using samples::single_contact;
using samples::vector_of;

constexpr AdhesionRule both_rules[] = {AdhesionRule::parallel, AdhesionRule::restrictive};
constexpr FrictionLaw both_laws[] = {FrictionLaw::cone, FrictionLaw::pyramid};

TEST(ContactResidual, VanishesForTheSlidingPoint) {
  const ContactProblem problem = single_contact({-1, 3, 4}, 0.5);

  const ContactResidual cone =
      residual_of(problem, std::vector<double>{1.0, -0.3, -0.4}, {}, {.law = FrictionLaw::cone});
  const ContactResidual pyramid =
      residual_of(problem, std::vector<double>{1.0, -0.5, -0.5}, {}, {.law = FrictionLaw::pyramid});

  EXPECT_LE(cone.eta, 1e-16);
  EXPECT_LE(cone.fclib, 1e-16);
  EXPECT_EQ(pyramid.eta, 0);
  EXPECT_EQ(pyramid.fclib, 0);
  EXPECT_EQ(cone.penetration, 0);
}

TEST(ContactResidual, MeasuresNoImpulseAtAllAsOne) {
  for (const FrictionLaw law : both_laws) {
    const ContactResidual residual = residual_of(
        single_contact({-2, 0, 1}, 0.5), std::vector<double>{0.0, 0.0, 0.0}, {}, {.law = law});

    EXPECT_DOUBLE_EQ(residual.eta, 1);
    EXPECT_EQ(residual.penetration, 2);
    EXPECT_EQ(residual.largest_contact, 0);
  }
}

TEST(ContactResidual, HasTheResidualOfAPulledSpringUnderEveryLaw) {
  ContactProblem problem = single_contact({1, 0, 0}, 0.5);
  problem.adhesion = bond(0.25);
  const std::vector impulse{-0.2, 0.0, 0.0};  // -kappa u0 / (1 + kappa)

  for (const FrictionLaw law : both_laws) {
    for (const AdhesionRule rule : both_rules) {
      const ContactResidual right = residual_of(problem, impulse, {}, {.law = law, .rule = rule});
      const ContactResidual wrong = residual_of(problem, std::vector<double>{-0.25, 0.0, 0.0}, {},
                                                {.law = law, .rule = rule});
      EXPECT_LE(right.eta, 1e-16);
      EXPECT_LE(right.fclib, 1e-16);
      EXPECT_GT(wrong.eta, 0.01);
      EXPECT_GT(wrong.fclib, 0.01);
    }
  }
}

TEST(ContactResidual, CountsAnOpenFrictionlessContactAsSolvedInFclibsTerms) {
  const ContactResidual residual =
      residual_of(single_contact({1, 0, 0}, 0), std::vector<double>{0.0, 0.0, 0.0}, {});

  EXPECT_EQ(residual.fclib, 0);
  EXPECT_EQ(residual.eta, 0);
}

TEST(ContactResidual, FclibErrorIsTheDistanceToCoulombsCone) {
  // u = (1, 3, 4) gives u~ = (3.5, 3, 4); r - u~ = (-1.5, -3, -4) projects on the cone at normal
  // part (0.5 * 5 - 1.5) / 1.25 = 0.8, tangents -0.4 (3, 4) / 5.
  const ContactProblem problem = single_contact({-1, 3, 4}, 0.5);

  const ContactResidual residual = residual_of(problem, std::vector<double>{2.0, 0.0, 0.0}, {});

  const double distance = std::hypot(2 - 0.8, 0.24, 0.32);
  EXPECT_NEAR(residual.fclib, distance / std::sqrt(26.0), 1e-15);
}

TEST(ContactResidual, AddsUpEnergiesAndNamesTheLargestContact) {
  // Two uncoupled contacts; the second has half of its impulse.
  ContactProblem problem;
  problem.delassus = samples::sparse_of(Eigen::MatrixXd::Identity(6, 6) * 2);
  problem.free_velocity = {-2, 0, 0, -4, 0, 0};
  problem.friction = {0, 0};

  const ContactResidual residual =
      residual_of(problem, std::vector<double>{1.0, 0, 0, 1.0, 0, 0}, {});

  // u = (0, -2), rho_n = 1/2: e = (0, -1), energy 2; none: e = (-1, -2), energy 10; r B r = 4.
  EXPECT_DOUBLE_EQ(residual.eta, std::sqrt(2.0) / (std::sqrt(10.0) + 2));
  EXPECT_DOUBLE_EQ(residual.largest, residual.eta);
  EXPECT_EQ(residual.largest_contact, 1);
  EXPECT_EQ(residual.penetration, 2);
}

class GlobalResidual : public testing::TestWithParam<double> {
 protected:
  GlobalResidual() {
    std::mt19937 random(11);
    problem = samples::random_global(random, 5, 6, GetParam(), 0.4);
    impulse = list_of(samples::random_vector(random, 3 * problem.contact_count()));
    const Eigen::MatrixXd jacobian = make_dense(problem.jacobian);
    const Eigen::MatrixXd system = make_dense(problem.system);
    const Eigen::VectorXd load = vector_of(problem.load);
    delassus = jacobian * samples::solve_spd(system, jacobian.transpose());
    velocity = samples::solve_spd(system, load + jacobian.transpose() * vector_of(impulse));
    local_problem.delassus = samples::sparse_of(delassus);
    local_problem.free_velocity =
        list_of(jacobian * samples::solve_spd(system, load) + vector_of(problem.velocity_offset));
    local_problem.friction = problem.friction;
  }

  static Eigen::MatrixXd make_dense(const SparseMatrix& matrix) {
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(matrix.rows, matrix.columns);
    for (Eigen::Index row = 0; row < dense.rows(); ++row) {
      for (auto e = static_cast<std::size_t>(matrix.row_start[static_cast<std::size_t>(row)]);
           e < static_cast<std::size_t>(matrix.row_start[static_cast<std::size_t>(row) + 1]); ++e) {
        dense(row, matrix.column[e]) += matrix.value[e];
      }
    }
    return dense;
  }

  ContactProblem problem;
  ContactProblem local_problem;  ///< the same problem
  std::vector<double> impulse;
  Eigen::VectorXd velocity;
  Eigen::MatrixXd delassus;
};

TEST_P(GlobalResidual, HasTheDelassusBlocksOfTheWholeSystem) {
  const std::vector<Eigen::Matrix3d> blocks =
      Delassus(problem, std::numeric_limits<double>::infinity()).diagonal_blocks();

  for (std::size_t c = 0; c < blocks.size(); ++c) {
    const auto row = 3 * static_cast<Eigen::Index>(c);
    EXPECT_TRUE(blocks[c].isApprox(delassus.block<3, 3>(row, row), 1e-13)) << "contact " << c;
  }
}

TEST_P(GlobalResidual, AgreesWithTheLocalForm) {
  for (const FrictionLaw law : both_laws) {
    const ContactResidual global = residual_of(problem, impulse, {}, {.law = law});
    const ContactResidual local = residual_of(local_problem, impulse, {}, {.law = law});

    EXPECT_NEAR(global.eta, local.eta, 1e-12 * local.eta);
    EXPECT_NEAR(global.fclib, local.fclib, 1e-12 * local.fclib);
    EXPECT_NEAR(global.penetration, local.penetration, 1e-12 * local.penetration);
    EXPECT_EQ(global.largest_contact, local.largest_contact);
    EXPECT_LE(global.balance, 1e-14);
    EXPECT_EQ(local.balance, 0);
  }
}

TEST_P(GlobalResidual, FindsGivenVelocitiesOutOfBalance) {
  const Eigen::VectorXd wrong = 1.25 * velocity;

  const ContactResidual right = residual_of(problem, impulse, list_of(velocity));
  const ContactResidual residual = residual_of(problem, impulse, list_of(wrong));

  const Eigen::VectorXd pushed = make_dense(problem.jacobian).transpose() * vector_of(impulse);
  const Eigen::VectorXd load = vector_of(problem.load);
  EXPECT_LE(right.balance, 1e-14);
  EXPECT_NEAR(residual.balance,
              (0.25 * (pushed + load)).norm() / std::max(pushed.norm(), load.norm()), 1e-13);
}

TEST_P(GlobalResidual, IsTheSameInOtherUnits) {
  // Lengths times 8, times times 4, masses times 1024: v 2, r 2048, W 1/1024.
  ContactProblem scaled = problem;
  for (double& value : scaled.system.value) value *= 1024;
  for (double& value : scaled.load) value *= 2048;
  for (double& value : scaled.velocity_offset) value *= 2;
  std::vector<double> scaled_impulse = impulse;
  for (double& value : scaled_impulse) value *= 2048;

  EXPECT_NEAR(residual_of(scaled, scaled_impulse, {}).eta, residual_of(problem, impulse, {}).eta,
              1e-14);
}

INSTANTIATE_TEST_SUITE_P(CoupledBy, GlobalResidual, testing::Values(0.0, 0.3), [](auto& info) {
  return info.param == 0 ? std::string("Nothing") : std::string("Links");
});

TEST(ContactResidual, VelocitiesWithoutImpulsesHideNoWrongImpulse) {
  // Falling bodies without impulses, but with the velocities of bodies at rest.
  std::mt19937 random(12);
  ContactProblem problem = samples::random_global(random, 2, 6, 0, 0.4);
  problem.velocity_offset.assign(problem.velocity_offset.size(), 0);
  const std::vector<double> none(problem.velocity_offset.size(), 0);

  const ContactResidual residual =
      residual_of(problem, none, std::vector<double>(problem.load.size(), 0));

  EXPECT_DOUBLE_EQ(residual.eta, 1);
  EXPECT_DOUBLE_EQ(residual.balance, 1);
}

TEST(ContactResidual, LimitsTheRecoverySpeedOfPenetration) {
  ContactProblem problem;
  problem.system = samples::sparse_of(Eigen::Matrix3d::Identity());
  problem.jacobian = problem.system;
  problem.load = {0, 0, 0};
  problem.velocity_offset = {-5, 0, 0};
  problem.friction = {0};

  EXPECT_EQ(residual_of(problem, std::vector<double>{5.0, 0, 0}, {}).eta, 0);
  EXPECT_EQ(residual_of(problem, std::vector<double>{2.0, 0, 0}, {}, {.recovery_speed = 2}).eta, 0);
  EXPECT_GT(residual_of(problem, std::vector<double>{5.0, 0, 0}, {}, {.recovery_speed = 2}).eta,
            0.1);
}

TEST(ContactResidual, NeverPassesForAResultThatIsNotANumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const FrictionLaw law : both_laws) {
    for (std::size_t row = 0; row < 3; ++row) {
      std::vector impulse{1.0, 0.0, 0.0};
      impulse[row] = nan;
      EXPECT_FALSE(residual_of(single_contact({-1, 1, 0}, 0.5), impulse, {}, {.law = law}).eta < 1);
    }
  }
}

TEST(ContactResidual, RefusesResultsOfAnotherSize) {
  const ContactProblem problem = single_contact({-1, 0, 0}, 0.5);

  EXPECT_THROW(residual_of(problem, std::vector<double>{1.0, 0.0}, {}), std::invalid_argument);
  std::mt19937 random(13);
  const ContactProblem global = samples::random_global(random, 2, 6, 0, 0.4);
  EXPECT_THROW(residual_of(global, std::vector<double>(9), std::vector<double>(11)),
               std::invalid_argument);
}

TEST(ContactResidual, RefusesASystemThatOnlyItsBlocksMakeLookPositive) {
  ContactProblem problem;
  Eigen::MatrixXd system = Eigen::MatrixXd::Identity(6, 6);
  system(0, 3) = system(3, 0) = 2;
  problem.system = samples::sparse_of(system);
  problem.jacobian = samples::sparse_of(Eigen::MatrixXd::Identity(3, 6));
  problem.load.assign(6, 0);
  problem.velocity_offset = {0, 0, 0};
  problem.friction = {0};
  problem.block_start = {0, 3, 6};

  EXPECT_THROW(residual_of(problem, std::vector<double>{0.0, 0.0, 0.0}, {}), ContactProblemError);
}
}  // namespace
}  // namespace tetwarp

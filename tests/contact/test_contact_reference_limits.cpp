/// @file test_contact_reference_limits.cpp
/// Limits of the contact laws on one contact, where they have closed forms, in back end reference:
/// B = 1/kg along every axis, kappa = 0.3 kg, friction 0.5.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "host/reference/contact/contact.hpp"
#include "tests/support/contact/contact_samples.hpp"

namespace tetwarp {
namespace {
using samples::bond;
using samples::single_contact;

struct Laws {
  FrictionLaw law;
  AdhesionRule rule;
};

class ReferenceLimit : public testing::TestWithParam<Laws> {
 protected:
  std::vector<double> impulse_of(const ContactProblem& problem) const {
    const ContactSolution solution = solve_contacts_reference(
        problem, {.law = GetParam().law, .rule = GetParam().rule, .tolerance = 1e-12});
    EXPECT_TRUE(solution.converged());
    return solution.impulse;
  }
};

constexpr double kappa = 0.3;
constexpr double exact = 1e-14;

TEST_P(ReferenceLimit, WithoutAdhesionIsCoulombFriction) {
  EXPECT_NEAR(impulse_of(single_contact({-1, 1, 0}, 0.5))[1], -0.5, exact);
  EXPECT_NEAR(impulse_of(single_contact({-1, 0.25, 0}, 0.5))[1], -0.25, exact);
}

TEST_P(ReferenceLimit, WithoutFrictionIsTheSpringAlone) {
  ContactProblem problem = single_contact({-1, 1, 0}, 0);
  problem.adhesion = bond(kappa);

  const std::vector<double> impulse = impulse_of(problem);

  EXPECT_NEAR(impulse[0], 1, exact);
  EXPECT_NEAR(impulse[1], -kappa / (1 + kappa), exact);
}

TEST_P(ReferenceLimit, InTractionIsTheSpringAlone) {
  ContactProblem problem = single_contact({1, 1, -2}, 0.5);
  problem.adhesion = bond(kappa);

  const std::vector<double> impulse = impulse_of(problem);

  EXPECT_NEAR(impulse[0], -kappa / (1 + kappa), exact);
  EXPECT_NEAR(impulse[1], -kappa / (1 + kappa), exact);
  EXPECT_NEAR(impulse[2], 2 * kappa / (1 + kappa), exact);
}

TEST_P(ReferenceLimit, OfBothAddsThemOrTakesTheLarger) {
  ContactProblem problem = single_contact({-1, 1, 0}, 0.5);
  problem.adhesion = bond(kappa);

  // Parallel: u = 1 - 0.5 - kappa u. Restrictive: the spring carries less than 0.5.
  const double u = 0.5 / (1 + kappa);
  EXPECT_NEAR(impulse_of(problem)[1],
              GetParam().rule == AdhesionRule::parallel ? -0.5 - kappa * u : -0.5, exact);
}

TEST_P(ReferenceLimit, OfAWeakBondIsThatOfNone) {
  ContactProblem problem = single_contact({-1, 1, 0}, 0.5);
  problem.adhesion = bond(1e-9);

  EXPECT_NEAR(impulse_of(problem)[1], -0.5, 1e-9);
}

TEST_P(ReferenceLimit, OfNoPressureIsReachedFromBothSides) {
  const auto impulse_at = [&](double velocity) {
    ContactProblem problem = single_contact({velocity, 1, 0}, 0.5);
    problem.adhesion = bond(kappa);
    return impulse_of(problem)[1];
  };

  EXPECT_NEAR(impulse_at(-1e-9), impulse_at(1e-9), 2e-9);
  EXPECT_NEAR(impulse_at(0), -kappa / (1 + kappa), exact);
}

TEST_P(ReferenceLimit, HoldsAStretchedSpringAsFarAsTheBoundGoes) {
  ContactProblem problem = single_contact({-1, 0, 0}, 0.5);
  problem.adhesion = bond(kappa);
  problem.adhesion.gap = {0, 1, 0};

  const std::vector<double> impulse = impulse_of(problem);

  if (GetParam().rule == AdhesionRule::parallel) {
    // The spring's 0.3 is within 0.5.
    EXPECT_NEAR(impulse[1], 0, exact);
  } else {
    // u = r slips towards the bond, r + 0.3 (u + 1) = 0.5 - 0.3 (u + 1).
    EXPECT_NEAR(impulse[1], -0.1 / 1.6, exact);
  }
}

TEST_P(ReferenceLimit, OfARecoilBeyondTheBondAddsOrTakesTheLarger) {
  ContactProblem problem = single_contact({-1, -3, 0}, 0.5);
  problem.adhesion = bond(kappa);
  problem.adhesion.gap = {0, 1, 0};

  const std::vector<double> impulse = impulse_of(problem);

  // Both u and u + o stay negative, so that spring and friction act in the same direction.
  if (GetParam().rule == AdhesionRule::parallel) {
    // r = 0.5 - 0.3 (u + 1), u = r - 3.
    EXPECT_NEAR(impulse[1], (0.2 + 0.9) / 1.3, exact);
  } else {
    EXPECT_NEAR(impulse[1], 0.5, exact);
  }
}

INSTANTIATE_TEST_SUITE_P(Of,
                         ReferenceLimit,
                         testing::Values(Laws{FrictionLaw::cone, AdhesionRule::parallel},
                                         Laws{FrictionLaw::cone, AdhesionRule::restrictive},
                                         Laws{FrictionLaw::pyramid, AdhesionRule::parallel},
                                         Laws{FrictionLaw::pyramid, AdhesionRule::restrictive}),
                         [](auto& info) {
                           return std::string(info.param.law == FrictionLaw::cone ? "Cone"
                                                                                  : "Pyramid") +
                                  (info.param.rule == AdhesionRule::parallel ? "Parallel"
                                                                             : "Restrictive");
                         });

TEST(ReferenceSlide, AlongADiagonalEndsOnTheDiscOrTheSquare) {
  const ContactProblem problem = single_contact({-1, 3, 4}, 0.5);

  const std::vector<double> cone =
      solve_contacts_reference(problem, {.law = FrictionLaw::cone}).impulse;
  const std::vector<double> pyramid =
      solve_contacts_reference(problem, {.law = FrictionLaw::pyramid}).impulse;

  EXPECT_NEAR(cone[1], -0.3, exact);
  EXPECT_NEAR(cone[2], -0.4, exact);
  EXPECT_NEAR(pyramid[1], -0.5, exact);
  EXPECT_NEAR(pyramid[2], -0.5, exact);
}
}  // namespace
}  // namespace tetwarp

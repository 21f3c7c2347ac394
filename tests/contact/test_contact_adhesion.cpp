/// @file test_contact_adhesion.cpp
/// The adhesion intensity over one step: closed forms, a fine integration, limits.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <stdexcept>
#include <tetwarp/contact.hpp>
#include <vector>

#include "kernels/contact/contact_adhesion.hpp"

namespace tetwarp::test {
namespace {
constexpr double dt = 0.01;                          // s
constexpr double area = 1e-4;                        // m^2
constexpr double stiffness = 1e7;                    // N/m^3
constexpr double energy = 0.1;                       // J/m^2
constexpr double viscosity = 0.5;                    // J s/m^2
const double onset = std::sqrt(energy / stiffness);  // gap at which beta = 1 starts to fall, m

using Gap3 = std::array<double, 3>;

/// Result of one contact.
struct Event {
  double intensity = 1;
  double normal_impulse = 0;
  Gap3 end_gap = {0, 0, 0};
};

struct Evolved {
  double intensity;
  Gap3 gap;
  bool debonded;
};

/// Contacts without an adhesive gap at the start of the step.
ContactProblem problem_of(const std::vector<Event>& events) {
  ContactProblem problem;
  problem.friction.assign(events.size(), 0.5);
  AdhesionState& adhesion = problem.adhesion;
  adhesion.time_step = dt;
  adhesion.area.assign(events.size(), area);
  adhesion.stiffness.assign(events.size(), stiffness);
  adhesion.energy.assign(events.size(), energy);
  adhesion.viscosity.assign(events.size(), viscosity);
  adhesion.bonding_rate.assign(events.size(), 1e-3);
  adhesion.saturation_pressure.assign(events.size(), 2e3);
  for (const Event& event : events) adhesion.intensity.push_back(event.intensity);
  return problem;
}

ContactSolution solution_of(const std::vector<Event>& events) {
  ContactSolution solution;
  for (const Event& event : events) {
    solution.impulse.insert(solution.impulse.end(), {event.normal_impulse, 0, 0});
    for (const double gap : event.end_gap) solution.velocity.push_back(gap / dt);
  }
  return solution;
}

Evolved evolved(const ContactProblem& problem, const Event& event, EvolutionOptions options = {}) {
  const AdhesionStep step = evolve_adhesion(problem, solution_of({event}), options);
  return {step.intensity[0], {step.gap[0], step.gap[1], step.gap[2]}, step.debonded[0] != 0};
}

Evolved evolved(const Event& event, EvolutionOptions options = {}) {
  return evolved(problem_of({event}), event, options);
}

double rate_of(const IntensityLaw& law, double beta) {
  return std::max(law.bonding - law.bonding_decay * beta, 0.0) +
         std::min(law.cohesion - law.strain * beta, 0.0);
}

/// Classical Runge-Kutta in 20000 steps.
double integrated(const IntensityLaw& law, double beta, double time) {
  constexpr int steps = 20000;
  const double h = time / steps;
  for (int step = 0; step < steps; ++step) {
    const double a = rate_of(law, beta);
    const double b = rate_of(law, beta + h / 2 * a);
    const double c = rate_of(law, beta + h / 2 * b);
    const double d = rate_of(law, beta + h * c);
    beta += h / 6 * (a + 2 * b + 2 * c + d);
  }
  return std::min(beta, 1.0);
}

/// Random laws whose rates times the time reach 20, with both orders of the two rest points.
/// Runge-Kutta's error at a kink is (20 / 20000)^2 of a rate of 20 over a step: below 1e-7.
TEST(ContactAdhesion, ExactIntegratorAgreesWithAFineIntegration) {
  std::mt19937_64 random(20260301);
  std::uniform_real_distribution<double> exponent(-2, std::log10(20.0));
  std::uniform_real_distribution<double> fraction(0, 1);
  for (int trial = 0; trial < 300; ++trial) {
    IntensityLaw law;
    law.bonding_decay = std::pow(10, exponent(random));
    law.bonding = law.bonding_decay * 1.5 * fraction(random);
    law.strain = std::pow(10, exponent(random));
    law.cohesion = law.strain * 1.5 * fraction(random);
    const double beta = fraction(random);

    const double exact = exact_intensity(law, beta, 1);

    EXPECT_NEAR(exact, integrated(law, beta, 1), 1e-7) << "trial " << trial;
  }
}

/// Pulled and pressed at once, with debonding from beta = 0.2 on and bonding up to 0.8: from 0 or
/// 1, beta enters the range in which both act and converges to their equilibrium, 0.5.
TEST(ContactAdhesion, ReachesTheRestPointOfBothEffectsFromEitherEnd) {
  const IntensityLaw law{.bonding = 8, .bonding_decay = 10, .cohesion = 2, .strain = 10};

  EXPECT_NEAR(exact_intensity(law, 0, 10), 0.5, 1e-15);
  EXPECT_NEAR(exact_intensity(law, 1, 10), 0.5, 1e-15);
  const double to_corner = std::log(0.8 / 0.6) / 10;  // bonding alone, from 0 to 0.2
  EXPECT_NEAR(exact_intensity(law, 0, to_corner), 0.2, 1e-15);
  EXPECT_NEAR(exact_intensity(law, 0, to_corner + 0.05), 0.5 - 0.3 * std::exp(-1), 1e-15);
}

TEST(ContactAdhesion, DecaysToItsRestPointAndNoFurther) {
  const IntensityLaw law{.cohesion = 1, .strain = 16};  // a gap of 4 onsets

  EXPECT_EQ(exact_intensity(law, 1.0 / 16, 1e6), 1.0 / 16);
  EXPECT_NEAR(exact_intensity(law, 1, 1e6), 1.0 / 16, 1e-16);
  EXPECT_NEAR(exact_intensity(law, 1, 0.1), 1.0 / 16 + 15.0 / 16 * std::exp(-1.6), 1e-15);
}

TEST(ContactAdhesion, AcceptsRatesOfAnySize) {
  for (const double rate : {0.0, 1e-300, 1e-20, 1.0, 1e20, 1e300}) {
    for (const double decay : {0.0, 1e-300, 1e-20, 1.0, 1e20, 1e300}) {
      for (const double strain : {0.0, 1e-300, 1.0, 1e300}) {
        for (const double beta : {0.0, 1e-300, 0.5, 1.0}) {
          const double end = exact_intensity({rate, decay, rate / 2, strain}, beta, 0.5);

          EXPECT_TRUE(end >= 0 && end <= 1) << rate << " " << decay << " " << strain << " " << end;
        }
      }
    }
  }
}

/// With x = dt C g^2 / eta and a gap of 4 onsets the rest point is 1/16. One step past it freezes.
TEST(ContactAdhesion, ExplicitEulerFreezesBelowTheRestPointBeyondItsLimit) {
  for (const double x : {0.5, 0.99, 1.05, 1.5, 10.0}) {
    const IntensityLaw law{.cohesion = x / 16, .strain = x};
    double euler = 1, exact = 1;
    for (int step = 0; step < 40; ++step) {
      euler = euler_intensity(law, euler, 1);
      exact = exact_intensity(law, exact, 1);
    }

    EXPECT_NEAR(exact, 1.0 / 16, std::exp(-40 * x) + 1e-15);
    const double frozen = std::max(1 - 15.0 / 16 * x, 0.0);
    EXPECT_NEAR(euler, x < 1 ? 1.0 / 16 : frozen, std::pow(std::max(1 - x, 0.0), 40) + 1e-15);
  }
}

TEST(ContactAdhesion, StaysBondedUpToTheOnsetAndFallsBeyond) {
  EXPECT_EQ(evolved({.end_gap = {0.999 * onset, 0, 0}}).intensity, 1);
  EXPECT_EQ(evolved({.end_gap = {0, 0.999 * onset, 0}}).intensity, 1);
  EXPECT_LT(evolved({.end_gap = {1.001 * onset, 0, 0}}).intensity, 1);
  EXPECT_LT(evolved({.end_gap = {0.8 * onset, 0, 0.7 * onset}}).intensity, 1);
}

TEST(ContactAdhesion, NormalGapsDebondInTractionOnly) {
  const Event pulled{.normal_impulse = -1e-3, .end_gap = {3 * onset, 0, 0}};
  Event pushed = pulled;
  pushed.normal_impulse = 1e-3;

  const double rest = 1.0 / 9;
  const double expected = rest + (1 - rest) * std::exp(-dt * 9 * energy / viscosity);
  EXPECT_NEAR(evolved(pulled).intensity, expected, 1e-15);
  EXPECT_EQ(evolved(pushed).intensity, 1);
}

TEST(ContactAdhesion, FrictionDebondsNothing) {
  const Event held{.intensity = 0.7, .normal_impulse = 1e-4};
  ContactSolution solution = solution_of({held});
  solution.impulse[1] = 1e3;

  const AdhesionStep step = evolve_adhesion(problem_of({held}), solution);

  EXPECT_EQ(step.intensity[0], 0.7);
}

/// Pressure 1 kPa of a saturation of 2 kPa: the rest point is 1/2, the rate r p0 = 2/s.
TEST(ContactAdhesion, BondsUnderCompressionTowardsTheSharesOfThePressure) {
  const double impulse = 1e3 * dt * area;

  EXPECT_NEAR(evolved({.intensity = 0, .normal_impulse = impulse}).intensity,
              0.5 * (1 - std::exp(-2 * dt)), 1e-15);
  EXPECT_EQ(evolved({.intensity = 0.6, .normal_impulse = impulse}).intensity, 0.6);
  EXPECT_EQ(evolved({.intensity = 0, .normal_impulse = -impulse}).intensity, 0);
  EXPECT_EQ(evolved({.intensity = 0.9, .normal_impulse = 1e9 * impulse}).intensity, 1);
}

/// The spring's force C beta^2 g is constant; its energy C beta^2 g^2 decreases in proportion to
/// the gap.
TEST(ContactAdhesion, BondsThatFormMoveTheAnchorsSoThatTheForceIsContinuous) {
  const Event sheared{
      .intensity = 0.3, .normal_impulse = 5e-3, .end_gap = {0, 0.5 * onset, -onset}};

  const Evolved next = evolved(sheared);

  ASSERT_GT(next.intensity, 0.3);
  const double ratio = next.intensity / 0.3;
  EXPECT_NEAR(ratio * ratio * next.gap[1], 0.5 * onset, 1e-15 * onset);
  EXPECT_NEAR(ratio * ratio * next.gap[2], -onset, 1e-15 * onset);
}

TEST(ContactAdhesion, KeepsTheGapWhereNoBondForms) {
  const Event pulled{.normal_impulse = -1e-3, .end_gap = {onset, 2 * onset, -onset}};

  const Evolved next = evolved(pulled);

  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(next.gap[axis], pulled.end_gap[axis], 1e-15 * onset);
  }
}

TEST(ContactAdhesion, DebondsBeyondTenOnsetsOrBelowAThousandthInTraction) {
  const Event faint_pull{.intensity = 5e-4, .normal_impulse = -1e-9, .end_gap = {onset, 0, 0}};
  Event faint_push = faint_pull;
  faint_push.normal_impulse = 1e-9;

  EXPECT_FALSE(evolved({.end_gap = {9.9 * onset, 0, 0}}).debonded);
  EXPECT_FALSE(evolved(faint_push).debonded);
  for (const Event& event :
       {Event{.end_gap = {10.1 * onset, 0, 0}},
        Event{.normal_impulse = 1, .end_gap = {0, 0, -10.1 * onset}}, faint_pull}) {
    const Evolved next = evolved(event);
    EXPECT_TRUE(next.debonded);
    EXPECT_EQ(next.intensity, 0);
    EXPECT_EQ(next.gap[2], 0);
  }
  EXPECT_FALSE(evolved({.intensity = 0, .end_gap = {1, 0, 0}}).debonded);  // there was no bond
}

TEST(ContactAdhesion, TakesBothStiffnessesForTheStrain) {
  const Event sheared{.end_gap = {0, 2.9 * onset, 0}};
  ContactProblem problem = problem_of({sheared});
  problem.adhesion.tangential_stiffness = {stiffness / 9};

  EXPECT_EQ(evolved(problem, sheared).intensity, 1);
  EXPECT_LT(evolved(sheared).intensity, 1);
}

TEST(ContactAdhesion, VectorsLeftOutHaveNoEffect) {
  const Event pulled{.normal_impulse = -1, .end_gap = {1, 0, 0}};
  for (std::vector<double> AdhesionState::*absent :
       {&AdhesionState::energy, &AdhesionState::viscosity}) {
    ContactProblem problem = problem_of({pulled});
    (problem.adhesion.*absent).clear();
    EXPECT_EQ(evolved(problem, pulled).intensity, 1);
  }
  const Event pushed{.intensity = 0, .normal_impulse = 1};
  ContactProblem problem = problem_of({pushed});
  problem.adhesion.bonding_rate.clear();
  EXPECT_EQ(evolved(problem, pushed).intensity, 0);
  problem.adhesion = {};
  EXPECT_TRUE(evolve_adhesion(problem, solution_of({pushed})).intensity.empty());
}

TEST(ContactAdhesion, EveryContactIsOnItsOwn) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> spread(-1, 1);
  for (const std::size_t size : {0U, 1U, 31U, 32U, 33U, 1025U}) {
    std::vector<Event> events(size);
    for (Event& event : events) {
      event = {std::abs(spread(random)), 1e-2 * spread(random), {}};
      for (double& gap : event.end_gap) gap = 4 * onset * spread(random);
    }

    const AdhesionStep step = evolve_adhesion(problem_of(events), solution_of(events));

    ASSERT_EQ(step.intensity.size(), size);
    for (std::size_t c = 0; c < size; ++c) {
      EXPECT_EQ(step.intensity[c], evolved(events[c]).intensity);
      EXPECT_EQ(step.gap[3 * c + 1], evolved(events[c]).gap[1]);
    }
  }
}

TEST(ContactAdhesion, RefusesSizesThatDoNotMatch) {
  ContactProblem problem = problem_of({{}});
  ContactSolution solution = solution_of({{}, {}});
  EXPECT_THROW(evolve_adhesion(problem, solution), std::invalid_argument);
  solution = solution_of({{}});
  EXPECT_THROW(evolve_adhesion(problem, solution, {.debond_gap_factor = 0}), std::invalid_argument);
  problem.adhesion.energy.push_back(1);
  EXPECT_THROW(evolve_adhesion(problem, solution), ContactProblemError);
}
}  // namespace
}  // namespace tetwarp::test

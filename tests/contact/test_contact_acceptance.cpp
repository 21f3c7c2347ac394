/// @file test_contact_acceptance.cpp
/// Rigid blocks against the laws of statics and energy: hanging, on a wall, on an incline, bonding
/// while sheared, in a mirror and in other orders; an elastic block and its outer iteration.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "host/contact/tracker/geometry.hpp"
#include "tests/support/block_scenes.hpp"
#include "tests/support/contact/contact_transforms.hpp"
#include "tests/support/elastic_block.hpp"

namespace tetwarp::test {
namespace {
class EachLaw : public ::testing::TestWithParam<FrictionLaw> {};
using BlockAcceptance = EachLaw;
INSTANTIATE_TEST_SUITE_P(Each,
                         BlockAcceptance,
                         ::testing::Values(FrictionLaw::cone, FrictionLaw::pyramid),
                         [](const ::testing::TestParamInfo<FrictionLaw>& info) {
                           return info.param == FrictionLaw::cone ? "cone" : "pyramid";
                         });

TEST_P(BlockAcceptance, AHungBlockStretchesTheBondByItsWeight) {
  for (const double stiffness : {1e6, 1e8}) {
    for (const double intensity : {1.0, 0.5}) {
      WorldOptions options = world_options(glue(stiffness, 0.5, intensity), 0.01);
      options.solving.law = GetParam();
      RigidWorld world = hung_block(options);
      run(world, 400);

      const double expected = gravity / (block_face * stiffness * intensity * intensity);
      EXPECT_NEAR(-world.boxes[0].pose.position[2], expected, 1e-10 * expected);
    }
  }
}

/// Mean gap of the anchors along gravity.
double sag(const RigidWorld& world) {
  double sum = 0;
  for (const TrackedContact& contact : world.contacts()) {
    Eigen::Vector3d gap = contact.gap[1] * vector_of(contact.axes[1]);
    gap += contact.gap[2] * vector_of(contact.axes[2]);
    const double sign = contact.key.body_a == 0 ? 1 : -1;  // gaps are of a from b
    sum += sign * gap.z() / static_cast<double>(world.contacts().size());
  }
  return sum;
}

/// Of the four corners two are pulled and two pressed. With rule `restrictive` friction adds
/// nothing, so that the springs carry the weight for any step.
TEST_P(BlockAcceptance, OnAWallTheSpringsCarryTheWeightWhateverTheStepAndNothingCreeps) {
  const double stiffness = 1e7;
  const double expected = gravity / (block_face * stiffness);
  for (const double dt : {1e-3, 4e-3}) {
    WorldOptions options = world_options(glue(stiffness), dt);
    options.solving.law = GetParam();
    options.solving.rule = AdhesionRule::restrictive;
    RigidWorld world = walled_block(options);
    run(world, 1000);

    ASSERT_EQ(world.contacts().size(), 4U);
    int pulled = 0;
    for (std::size_t row = 0; row < 12; row += 3) pulled += world.solution().impulse[row] < 0;
    EXPECT_EQ(pulled, 2);
    EXPECT_NEAR(sag(world), expected, 1e-9 * expected) << dt;
    EXPECT_LT(world.boxes[0].velocity.norm(), 1e-9 * gravity * dt);
  }
}

/// Rule `parallel`: friction of the pressed pair carries a share.
TEST_P(BlockAcceptance, OnAWallFrictionOfThePressedPairHelpsTheSprings) {
  WorldOptions options = world_options(glue(1e7), 2e-3);
  options.solving.law = GetParam();
  RigidWorld world = walled_block(options);
  run(world, 1000);

  const double share = sag(world) * block_face * 1e7 / gravity;
  EXPECT_LT(share, 0.999);
  EXPECT_GT(share, 0.9);
}

TEST_P(BlockAcceptance, OnAnInclineItSticksBelowTheFrictionAngleAndSlidesAboveIt) {
  constexpr double friction = 0.5;
  constexpr int steps = 100;
  for (const double share : {0.99, 1.01}) {
    const double angle = std::atan(share * friction);
    WorldOptions options = world_options({.friction = friction}, 5e-3);
    options.solving.law = GetParam();
    options.gravity = {gravity * std::sin(angle), 0, -gravity * std::cos(angle)};
    RigidWorld world = laid_block(options);
    run(world, steps);

    const double slide =
        steps * options.time_step * gravity * (std::sin(angle) - friction * std::cos(angle));
    const double expected = std::max(slide, 0.0);
    EXPECT_NEAR(world.boxes[0].velocity.x(), expected, 1e-10) << share;
    EXPECT_NEAR(world.boxes[0].velocity.y(), 0, 1e-10);
  }
}

/// Bonds grow from beta = 0.1 to 1 under a block that slides to and fro on their springs, without
/// friction. With unmoved anchors, springs that stiffen while stretched would add a tenth of the
/// kinetic energy.
TEST_P(BlockAcceptance, BondsThatFormUnderShearAddNoEnergy) {
  ContactMaterial material = glue(1e6, 0, 0.1);
  material.bonding_rate = 0.01;
  material.saturation_pressure = 500;
  WorldOptions options = world_options(material, 1e-3);
  options.solving.law = GetParam();
  RigidWorld world = laid_block(options);
  world.boxes[0].velocity = {0.05, 0.02, 0};
  double before = world.energy();
  double gain = 0;
  for (int step = 0; step < 1000; ++step) {
    world.step();
    gain = std::max(gain, world.energy() - before);
    before = world.energy();
  }

  EXPECT_NEAR(world.tracker.records()[0].intensity, 1, 1e-12);
  EXPECT_LE(gain, 1e-12);
}

/// Corners of the stable range; the stress suite covers all of it.
TEST_P(BlockAcceptance, AKickedBlockOnTheCeilingGainsNoEnergy) {
  for (const double stiffness : {1e3, 1e7, 1e10}) {
    for (const double dt : {1e-4, 2e-2}) {
      WorldOptions options = world_options(glue(stiffness, 0), dt);
      options.solving.law = GetParam();
      options.gravity = {0, 0, 0};
      RigidWorld world = hung_block(options);
      world.boxes[0].velocity = {0.2, 0.1, -0.3};
      world.boxes[0].spin = {1, 0.5, 0.2};
      const double start = world.energy();
      double most = 0;
      // Stiff bonds stop the block within a few long steps; later energies are rounding errors.
      for (int step = 0; step < 100 && world.energy() > 1e-20 * start; ++step) {
        world.step();
        most = std::max(most, world.energy());
      }

      EXPECT_LE(most, start * (1 + 1e-12)) << stiffness << " " << dt;
    }
  }
}

/// 3x3x3 cubes of five tetrahedra, E = 1e5 Pa, 5 ms: the largest eigenvalue of D^-1 A is 2.5.
TEST(ElasticAcceptance, ThePlainOuterIterationDivergesAndHalfOfItConverges) {
  const ContactProblem problem = make_elastic_problem({.young = 1e5, .time_step = 5e-3});
  ContactOptions options = {.method = ContactMethod::gauss_seidel,
                            .tolerance = 1e-8,
                            .expert = {.coupling = ContactCoupling::iterated, .relaxation = 1}};

  const ContactSolution plain = solve_contacts(problem, options);
  options.expert.relaxation = 0.5;
  const ContactSolution relaxed = solve_contacts(problem, options);

  EXPECT_EQ(plain.report.status, ContactStatus::not_converged);
  EXPECT_TRUE(std::all_of(plain.body_velocity.begin(), plain.body_velocity.end(),
                          [](double v) { return std::isfinite(v); }));
  EXPECT_TRUE(relaxed.converged()) << relaxed.report.status_reason;
  EXPECT_LE(residual_of(problem, relaxed.impulse, relaxed.body_velocity).eta, 1e-8);
}

/// A step in which blocks of a stack land, slide and stretch bonds.
ContactCase busy_case(FrictionLaw law) {
  WorldOptions options = world_options(glue(1e5, 0.4), 2e-3);
  options.solving.law = law;
  RigidWorld world = stacked_blocks(options, 4, 0.7);
  for (std::size_t b = 0; b < 4; ++b) {
    world.boxes[b].velocity = {0.3 * static_cast<double>(b), 0.1, 0.2};
    world.boxes[b].spin = {0.5, -0.4, 1};
  }
  run(world, 5);
  return {world.problem(), world.solution().impulse, world.solution().body_velocity};
}

TEST_P(BlockAcceptance, OrderMirrorAndUnitsChangeResidualsByRoundingOnly) {
  ContactCase original = busy_case(GetParam());
  ASSERT_GT(original.problem.contact_count(), 8);
  // Half the solution: a residual that is not rounding itself.
  for (double& r : original.impulse) r /= 2;
  const ContactOptions options{.law = GetParam()};
  const auto eta_of = [&](const ContactCase& c) {
    return residual_of(c.problem, c.impulse, c.body_velocity, options).eta;
  };
  const double eta = eta_of(original);
  ASSERT_GT(eta, 1e-3);

  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    EXPECT_NEAR(eta_of(permuted(original, seed)), eta, 1e-13 * eta);
  }
  EXPECT_NEAR(eta_of(mirrored(original)), eta, 1e-13 * eta);
  for (const double factor : {1e-3, 1e3}) {
    EXPECT_NEAR(eta_of(rescaled(original, factor, 1, 1)), eta, 1e-11 * eta);
    EXPECT_NEAR(eta_of(rescaled(original, 1, factor, 1)), eta, 1e-11 * eta);
    EXPECT_NEAR(eta_of(rescaled(original, 1, 1, factor)), eta, 1e-11 * eta);
  }
}
}  // namespace
}  // namespace tetwarp::test

/// @file test_contact_stress.cpp
/// Energy of a kicked block that adheres to a ceiling, over eight decades of stiffness and steps
/// from 0.1 to 50 ms, with few sweeps and with many.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "kernels/contact/contact_adhesion.hpp"
#include "tests/support/block_scenes.hpp"

namespace tetwarp::test {
namespace {
struct EnergyRun {
  double max_energy = 0;  ///< after the start, as a fraction of the energy at the start
  bool is_finite = true;
  bool is_bond_valid = true;  ///< every beta in [0, 1]
};

/// A block without weight, thrown and spun against its bonds.
EnergyRun kicked_block(const ContactMaterial& material, double dt, std::int64_t sweeps, int steps) {
  WorldOptions options = world_options(material, dt);
  options.gravity = {0, 0, 0};
  options.margin = 0.02;
  options.solving.method = ContactMethod::gauss_seidel;
  options.solving.max_sweeps = sweeps;
  RigidWorld world = hung_block(options);
  world.boxes[0].velocity = {0.2, 0.1, -0.3};
  world.boxes[0].spin = {1, 0.5, 0.2};
  const double start = world.energy();
  EnergyRun run;
  // Stiff bonds stop the block within a few long steps.
  for (int step = 0; step < steps && world.energy() > 1e-20 * start; ++step) {
    world.step();
    const double energy = world.energy() / start;
    run.max_energy = std::max(run.max_energy, energy);
    run.is_finite = run.is_finite && std::isfinite(energy);
    for (const ContactRecord& record : world.tracker.records()) {
      run.is_bond_valid = run.is_bond_valid && record.intensity >= 0 && record.intensity <= 1;
    }
  }
  return run;
}

/// Law: with 10 or more sweeps per step the energy never exceeds the initial energy.
TEST(ContactStress, EnergyNeverExceedsTheStartWithTenSweepsOrMore) {
  const std::vector<double> steps = {1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 2e-2};
  for (const std::int64_t sweeps : {10, 25, 100}) {
    for (double stiffness = 1e3; stiffness <= 1e10; stiffness *= 10) {
      for (const double dt : steps) {
        const EnergyRun run = kicked_block(glue(stiffness), dt, sweeps, 100);

        EXPECT_TRUE(run.is_finite);
        EXPECT_LE(run.max_energy, 1 + 1e-12)
            << stiffness << " N/m^3, " << dt << " s, " << sweeps << " sweeps";
      }
    }
  }
}

/// With fewer sweeps energy may grow; it stays finite and beta stays in [0, 1].
TEST(ContactStress, BeyondTheLawNumbersStayFiniteAndIntensitiesInRange) {
  const std::vector<double> steps = {1e-3, 5e-3, 2e-2, 5e-2};
  ContactMaterial material = glue(0, 0.3);
  material.viscosity = 1;
  material.bonding_rate = 1e-2;
  material.saturation_pressure = 1e3;
  for (const std::int64_t sweeps : {1, 3, 9}) {
    for (const double stiffness : {1e6, 1e8, 1e10, 1e12}) {
      material.stiffness = stiffness;
      material.energy = 1e-6 * stiffness;  // onset at 1 mm
      for (const double dt : steps) {
        const EnergyRun run = kicked_block(material, dt, sweeps, 100);

        EXPECT_TRUE(run.is_finite) << stiffness << " " << dt << " " << sweeps;
        EXPECT_TRUE(run.is_bond_valid);
      }
    }
  }
}

/// Law: beta stays in [0, 1] for any rates, with either integrator.
TEST(ContactStress, IntensitiesStayInRangeForAnyRates) {
  std::mt19937_64 random(20260302);
  std::uniform_real_distribution<double> exponent(-12, 12);
  std::uniform_real_distribution<double> fraction(0, 1);
  for (int trial = 0; trial < 1000; ++trial) {
    double exact = fraction(random), euler = exact;
    for (int step = 0; step < 20; ++step) {
      const IntensityLaw law{std::pow(10, exponent(random)), std::pow(10, exponent(random)),
                             std::pow(10, exponent(random)), std::pow(10, exponent(random))};
      exact = exact_intensity(law, exact, 1e-3);
      euler = euler_intensity(law, euler, 1e-3);
      ASSERT_TRUE(exact >= 0 && exact <= 1) << exact << " in trial " << trial;
      ASSERT_TRUE(euler >= 0 && euler <= 1) << euler;
    }
  }
}
}  // namespace
}  // namespace tetwarp::test

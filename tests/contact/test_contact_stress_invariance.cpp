/// @file test_contact_stress_invariance.cpp
/// Solutions do not depend on the order of contacts and bodies, on mirroring, on units or on the
/// number of points that share a contact area.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/block_scenes.hpp"
#include "tests/support/contact/contact_transforms.hpp"

namespace tetwarp::test {
namespace {
/// A step in which glued blocks are pulled, pressed and sheared.
ContactCase busy_case(double friction, double ratio) {
  constexpr int count = 5;
  WorldOptions options = world_options(glue(1e6, friction), 2e-3);
  options.solving.tolerance = 1e-9;
  RigidWorld world = stacked_blocks(options, count, ratio);
  for (int b = 0; b < count; ++b) {
    RigidBox& box = world.boxes[static_cast<std::size_t>(b)];
    box.velocity = {0.1 * b, 0.05, 0.02 * b};
    box.spin = {0.2, -0.1, 0.3};
  }
  run(world, 3);
  return {world.problem(), world.solution().impulse, world.solution().body_velocity};
}

double kinetic_distance(const ContactCase& a, const std::vector<double>& velocity) {
  double difference = 0, size = 0;
  const SparseMatrix& system = a.problem.system;
  for (std::size_t row = 0; row < velocity.size(); ++row) {
    const auto end = static_cast<std::size_t>(system.row_start[row + 1]);
    for (auto e = static_cast<std::size_t>(system.row_start[row]); e < end; ++e) {
      const auto column = static_cast<std::size_t>(system.column[e]);
      difference += (velocity[row] - a.body_velocity[row]) * system.value[e] *
                    (velocity[column] - a.body_velocity[column]);
      size += a.body_velocity[row] * system.value[e] * a.body_velocity[column];
    }
  }
  return std::sqrt(std::max(difference, 0.0) / size);
}

using Images = std::vector<std::pair<std::string, ContactCase>>;

/// Solves every image to eta 1e-9 and compares its velocities with those of the case.
void expect_same_velocities(const Images& images) {
  for (const auto& [what, image] : images) {
    const ContactSolution solution = solve_contacts(image.problem, {.tolerance = 1e-9});

    EXPECT_TRUE(solution.converged()) << what << ": " << solution.report.status_reason;
    EXPECT_LE(kinetic_distance(image, solution.body_velocity), 1e-6) << what;
  }
}

/// Law: mirrored or in other units every sweep computes the same, with friction too.
TEST(ContactStress, MirrorsAndUnitsDoNotChangeTheSolution) {
  for (const double ratio : {1.0, 3.0}) {
    const ContactCase original = busy_case(0.4, ratio);
    Images images = {{"mirror", mirrored(original)}};
    for (const double factor : {1e-3, 1e3}) {
      const std::string times = " times " + std::to_string(factor);
      images.emplace_back("mass" + times, rescaled(original, factor, 1, 1));
      images.emplace_back("length" + times, rescaled(original, 1, factor, 1));
      images.emplace_back("time" + times, rescaled(original, 1, 1, factor));
    }

    SCOPED_TRACE(testing::Message() << "mass ratio " << ratio);
    expect_same_velocities(images);
  }
}

/// Law: without friction the velocities solve a strictly convex problem, so they do not depend on
/// the order of contacts and bodies. (With friction there may be several solutions.)
TEST(ContactStress, OrdersDoNotChangeTheFrictionlessSolution) {
  for (const double ratio : {1.0, 3.0}) {
    const ContactCase original = busy_case(0, ratio);
    Images images;
    for (const std::uint64_t seed : {11U, 12U, 13U}) {
      images.emplace_back("order " + std::to_string(seed), permuted(original, seed));
    }

    SCOPED_TRACE(testing::Message() << "mass ratio " << ratio);
    expect_same_velocities(images);
  }
}

/// Law: the force that separates a block is area sqrt(W C), independent of the number of points, 1,
/// 4, 16 or 64, that share the area. The pull grows by 2 % of it per eta / W: measured when the
/// last bond fails.
TEST(ContactStress, PullOffForceDoesNotDependOnTheNumberOfContactPoints) {
  ContactMaterial material = glue(1e6, 0.3);
  material.energy = 0.1;
  material.viscosity = 0.01;  // time scale eta / W: 0.1 s
  const double strength = block_face * std::sqrt(material.energy * material.stiffness);
  std::vector<double> forces;
  for (const int per_edge : {1, 2, 4, 8}) {
    WorldOptions options = world_options(material, 0.01);
    options.gravity = {0, 0, 0};
    options.solving.tolerance = 1e-9;
    RigidWorld world = hung_block(options, per_edge);
    double force = 0.8 * strength;
    while (world.boxes[0].pose.position[2] > -0.01 && force < 2 * strength) {
      force += 0.002 * strength;
      world.boxes[0].force = {0, 0, -force};
      world.step();
    }
    forces.push_back(force / strength);
  }

  for (const double force : forces) {
    EXPECT_EQ(force, forces[0]);
    EXPECT_GT(force, 1);
    EXPECT_LT(force, 1.2);
  }
}
}  // namespace
}  // namespace tetwarp::test

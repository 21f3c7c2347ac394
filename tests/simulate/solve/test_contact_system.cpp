/// Contact problems of steps and their solutions against dense algebra and the laws of contact.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "host/base/point3.hpp"
#include "host/simulate/model/rotations.hpp"
#include "host/simulate/solve/problem/contact_islands.hpp"
#include "host/simulate/solve/two_level/compliant_list_maker.hpp"
#include "tests/simulate/body_models.hpp"
#include "tests/simulate/mixed_contacts.hpp"

namespace tetwarp::test {
namespace {
using Eigen::VectorXd;
using Index = Eigen::Index;

constexpr double dt = mixed_step;

/// How fast point a moves away from point b, by a difference of positions along the velocities.
Point3 difference_velocity(const HandScene& scene,
                           const TrackedContact& contact,
                           const std::vector<Point3>& velocity) {
  const Model& model = scene.model;
  const Touch& touch = scene.touches[at(contact.key.feature_a / 2)];
  // Points of rigid bodies are where the contact has them.
  const auto place_after = [&](std::int32_t body, const MaterialPoint& point, const Point3& place,
                               double h) {
    ModelState moved = model.start;
    const std::int32_t frame = model.body_rigid[at(body)];
    MaterialPoint own = point;
    if (frame >= 0) {
      own.local = minus(place, model.start.position[at(model.node_count + frame)]);
      const std::size_t linear = at(model.node_count + 2 * frame);
      Point3& center = moved.position[at(model.node_count + frame)];
      center = plus(center, times(h, velocity[linear]));
      const Point3 half = times(h / 2, velocity[linear + 1]);
      moved.rotation[at(frame)] = normalized({1, half[0], half[1], half[2]});
    }
    for (std::int32_t n = 0; n < model.node_count; ++n) {
      moved.position[at(n)] = plus(moved.position[at(n)], times(h, velocity[at(n)]));
    }
    return scene.place_of(body, own, moved);
  };
  const auto speed = [&](std::int32_t body, const MaterialPoint& point, const Point3& place) {
    constexpr double h = 1e-5;
    return times(0.5 / h,
                 minus(place_after(body, point, place, h), place_after(body, point, place, -h)));
  };
  const Point3 apart = minus(speed(touch.body_a, touch.point_a, contact.point_a_world),
                             speed(touch.body_b, touch.point_b, contact.point_b_world));
  return {dot(contact.axes[0], apart), dot(contact.axes[1], apart), dot(contact.axes[2], apart)};
}

/// A v - b - J^T r of the rows with unknowns, largest component.
double imbalance(const StepSystem& system, const Solved& solved) {
  const SystemRows& rows = system.rows;
  double largest = 0;
  for (std::int32_t row = 0; row < rows.unknown_count; ++row) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t block = at(rows.block_of[row]);
      double sum = -system.load[3 * row + static_cast<int>(i)] - solved.impulses[block][i];
      for (std::int32_t k = rows.start[row]; k < rows.free_end[row]; ++k) {
        const Point3& v = solved.velocity[at(rows.block_of[rows.column[k]])];
        for (std::size_t c = 0; c < 3; ++c) {
          sum += system.values[9 * k + static_cast<int>(3 * c + i)] * v[c];
        }
      }
      largest = std::max(largest, std::abs(sum));
    }
  }
  return largest;
}

TEST(ContactSystem, SatisfiesMomentumAndTheLawOfEveryContact) {
  int closed = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(seed);
    const HandScene scene = mixed_scene(seed);
    const double friction = 0.3 * (seed % 4);

    const Solved solved = solve(scene, materials(friction), exact(), 1e-4);

    EXPECT_TRUE(solved.outcome.converged);
    EXPECT_LT(imbalance(solved.stepper->system(), solved), 1e-10);
    for (std::size_t c = 0; c < solved.contacts.size(); ++c) {
      const double* const r = solved.solution.impulse.data() + 3 * c;
      const double* const u = solved.solution.velocity.data() + 3 * c;
      const Point3 moved = difference_velocity(scene, solved.contacts[c], solved.velocity);
      EXPECT_NEAR(u[0], moved[0] + 1e-4 / dt, 1e-7);
      EXPECT_NEAR(u[1], moved[1], 1e-7);
      EXPECT_NEAR(u[2], moved[2], 1e-7);
      EXPECT_GE(r[0], 0);
      EXPECT_GT(u[0], -1e-8);
      EXPECT_LT(r[0] * u[0], 1e-9);
      const double push = std::hypot(r[1], r[2]), slip = std::hypot(u[1], u[2]);
      EXPECT_LE(push, friction * r[0] + 1e-10);
      // Sliding uses up the friction, along the slip.
      EXPECT_NEAR(r[1] * u[1] + r[2] * u[2], -friction * r[0] * slip, 1e-9);
      closed += r[0] > 0;
    }
  }
  EXPECT_GT(closed, 40);
}

TEST(ContactSystem, AgreesWithTheReference) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE(seed);
    const HandScene scene = mixed_scene(seed, 1e-4);
    const ContactTrackerOptions tracking = materials(0.4, seed % 2 == 0 ? 0 : 1e6);

    const Solved solved = solve(scene, tracking, exact(), 1e-5);
    const Solved reference = solve(scene, tracking, exact(Backend::reference), 1e-5);

    EXPECT_TRUE(solved.outcome.converged && reference.outcome.converged);
    for (std::size_t i = 0; i < solved.velocity.size(); ++i) {
      EXPECT_LT(distance(solved.velocity[i], reference.velocity[i]), 1e-7);
    }
  }
}

/// With springs nu = r + K (u + o), in traction r_n = -kappa_n u_n; see contact.hpp.
TEST(ContactSystem, SpringsPullAtTheGapAtTheEndOfTheStep) {
  const double stiffness = 1e6, area = 1e-4, kappa = dt * dt * area * stiffness;
  const HandScene scene = mixed_scene(3, area);

  const Solved solved = solve(scene, materials(0, stiffness), exact(), 0.0);

  int pulled = 0;
  for (std::size_t c = 0; c < solved.contacts.size(); ++c) {
    const double* const r = solved.solution.impulse.data() + 3 * c;
    const double* const u = solved.solution.velocity.data() + 3 * c;
    const Point3 moved = difference_velocity(scene, solved.contacts[c], solved.velocity);
    if (r[0] < 0) {
      EXPECT_NEAR(r[0], -kappa * moved[0], 1e-7);
    }
    EXPECT_NEAR(r[1], -kappa * (moved[1] + solved.contacts[c].gap[1] / dt), 1e-7);
    EXPECT_NEAR(u[0], moved[0], 1e-7);
    pulled += r[0] < 0;
  }
  EXPECT_GT(pulled, 1);
}

/// What contacts add to one body they take from another; of prescribed ones it is counted too.
TEST(ContactSystem, ImpulsesOnAllBlocksAddUpToNothing) {
  const Solved solved = solve(mixed_scene(1, 1e-4), materials(0.5, 1e6), exact());

  Point3 sum{0, 0, 0};
  double size = 0;
  for (std::size_t i = 0; i < solved.impulses.size(); ++i) {
    const bool is_angular = i > 53 && (i - 53) % 2 == 1;
    if (is_angular) continue;
    sum = plus(sum, solved.impulses[i]);
    size = std::max(size, norm(solved.impulses[i]));
  }

  EXPECT_GT(size, 1e-3);
  EXPECT_LT(norm(sum), 1e-15 + 1e-14 * size);
}

TEST(ContactSystem, IslandsWithoutContactsKeepTheirVelocities) {
  const HandScene scene = mixed_scene(2);
  ContactSystemOptions options = exact();

  const Solved some = solve(scene, materials(0.4), options);
  options.skips_islands = false;
  const Solved all = solve(scene, materials(0.4), options);

  const auto first = at(scene.model.body_node[3]), end = at(scene.model.body_node[4]);
  for (std::size_t i = 0; i < some.velocity.size(); ++i) {
    if (i >= first && i < end) {
      EXPECT_EQ(some.velocity[i], some.free[i]);
    }
    EXPECT_LT(distance(some.velocity[i], all.velocity[i]), 1e-9);
  }
  EXPECT_EQ(some.outcome.islands, 1);
}

TEST(ContactSystem, HasTheSameBitsForAnyNumberOfThreads) {
  const HandScene scene = mixed_scene(5);
  ContactSystemOptions options = exact();

  const Solved one = solve(scene, materials(0.4), options);
  options.solver.threads = 4;
  const Solved four = solve(scene, materials(0.4), options, 0.0, 4);

  EXPECT_EQ(one.velocity, four.velocity);
  EXPECT_EQ(one.solution.impulse, four.solution.impulse);
  EXPECT_EQ(one.impulses, four.impulses);
}

TEST(ContactSystem, WithoutContactsNothingChanges) {
  HandScene scene = mixed_scene(5);
  scene.touches.clear();

  const Solved solved = solve(scene, materials(0.4), exact());

  EXPECT_TRUE(solved.outcome.converged);
  EXPECT_EQ(solved.velocity, solved.free);
  EXPECT_EQ(solved.outcome.islands, 0);
}

/// A contact is left out only where all blocks that it acts on are prescribed: the end check of a
/// step watches every other pair, however small the share of its unknown blocks.
TEST(ContactIslands, KeepContactsThatMoveUnknownsByASmallShare) {
  Model model = empty_model();
  add_block(model, {.cells = {1, 1, 1}, .edge = 0.1});
  prescribe(model, 0);
  SceneSurfaces surfaces;
  for (const std::int32_t node : {0, 1}) surfaces.vertex_point.push_back(node_point(model, node));
  std::vector<ContactSides> contacts(3);
  const double share[] = {1e-4, 0, 1e-17};
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    contacts[c].a.vertex[0] = 0;
    contacts[c].a.vertex[1] = 1;
    contacts[c].a.weight[0] = 1 - share[c];
    contacts[c].a.weight[1] = share[c];
  }

  ContactIslands islands(surfaces, model);
  islands.join(contacts);

  EXPECT_EQ(islands.of_contact(), (std::vector<std::int32_t>{0, -1, -1}));
  EXPECT_EQ(islands.contact_island_count(), 1);
}

/// Lists on a device are sent anew only where others are needed.
TEST(CompliantListMaker, KeepsListsWhileTheSameIslandsAreTaken) {
  Model model = empty_model();
  add_block(model, {.cells = {1, 1, 1}, .edge = 0.1});
  add_rigid(model, 1, {1, 1, 1}, {0, 0, 1});
  prescribe(model, 3);
  const auto stepper = make_cpu_stepper(model, {});
  stepper->solve(input_for(model, dt, {0, 0, 0}));
  const SystemRows rows = stepper->system().rows;
  const ContactIslands islands({}, model);
  std::vector<std::int32_t> body_of(10, 0);
  body_of[8] = body_of[9] = -1;
  CompliantListMaker maker(body_of, 0.5), other(body_of, 0.5);

  maker.make(rows, islands, {1, 1});
  const CompliantLists both = maker.lists();
  ASSERT_EQ(both.bodies.size(), 2u);
  EXPECT_EQ(both.bodies[0].count, 7);
  EXPECT_EQ(both.bodies[1].first, 7);
  EXPECT_EQ(both.bodies[1].relaxation, 1);
  EXPECT_EQ(both.model_body, std::vector<std::int32_t>{0});
  EXPECT_EQ(both.row_of_block, (std::vector<std::int32_t>{0, 1, 2, -1, 3, 4, 5, 6, 7, 8}));
  maker.make(rows, islands, {1, 1});
  EXPECT_EQ(maker.lists().version, both.version);

  maker.make(rows, islands, {0, 1});
  EXPECT_NE(maker.lists().version, both.version);
  EXPECT_EQ(maker.lists().row_count(), 2);
  EXPECT_EQ(maker.lists().row_of_block[0], -1);
  other.make(rows, islands, {0, 1});
  EXPECT_NE(other.lists().version, maker.lists().version);
}

}  // namespace
}  // namespace tetwarp::test

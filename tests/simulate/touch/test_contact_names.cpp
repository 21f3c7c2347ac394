/// @file test_contact_names.cpp
/// No two contacts of a step have the same name, whatever touches.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/simulate/pair_scene.hpp"
#include "tests/simulate/touch_run.hpp"

namespace tetwarp::test {
namespace {

/// Contacts come sorted by key: equal ones would be neighbors.
void expect_own_names(const std::vector<ReportedContact>& contacts) {
  for (std::size_t c = 1; c < contacts.size(); ++c) {
    ASSERT_LT(contacts[c - 1].key, contacts[c].key) << c << " of " << contacts.size();
  }
}

constexpr int around_count = 400;

/// The ball is at `offset` within small triangles that all face its place at the origin at the same
/// distance, 10 degrees apart.
PairScene ball_among_triangles(double thickness, const Point3& offset) {
  const double golden = std::acos(-1.0) * (3 - std::sqrt(5.0));
  PairScene scene;
  scene.scene.surfaces.thickness = thickness;
  scene.add_sphere(offset, 1 - thickness, {});
  std::vector<Point3> vertices;
  std::vector<std::array<std::int32_t, 3>> triangles;
  for (int k = 0; k < around_count; ++k) {
    const double z = 1 - (2 * k + 1.0) / around_count, across = std::sqrt(1 - z * z);
    const Point3 out{across * std::cos(k * golden), across * std::sin(k * golden), z};
    const Point3 u = unit(cross(out, {0.6, 0, 0.8})), v = cross(out, u);
    const auto first = static_cast<std::int32_t>(vertices.size());
    for (const auto& [s, t] : {std::pair{1.0, 0.0}, {-0.5, -0.8}, {-0.5, 0.8}}) {
      vertices.push_back(plus(out, plus(times(0.01 * s, u), times(0.01 * t, v))));
    }
    triangles.push_back({first, first + 1, first + 2});
  }
  scene.add_mesh(vertices, triangles, {.is_rigid = false});
  return scene;
}

TEST(ContactNames, AreManyWhereABallTouchesABodyAllAround) {
  for (const double thickness : {1e-5, 1e-4, 1e-3, 1e-2}) {
    PairScene scene = ball_among_triangles(thickness, {0, 0, 0});
    const auto& contacts = scene.contacts();
    EXPECT_EQ(contacts.size(), static_cast<std::size_t>(around_count)) << thickness;
    expect_own_names(contacts);
  }
}

/// The ball moves, so that other triangles are nearest; some contacts have ended before, and their
/// numbers are free.
TEST(ContactNames, DifferWhereSomeAreTakenFromRecords) {
  std::vector<ContactRecord> records;
  PairScene before = ball_among_triangles(1e-3, {0, 0, 0});
  for (const ReportedContact& contact : before.contacts()) {
    if (contact.normal[0] < 0.5) {
      records.push_back({.key = contact.key, .normal_world = contact.normal});
    }
  }
  PairScene after = ball_among_triangles(1e-3, {3e-4, -2e-4, 1e-4});
  const auto& contacts = after.contacts(records);
  ASSERT_EQ(contacts.size(), static_cast<std::size_t>(around_count));
  expect_own_names(contacts);
  std::size_t found = 0;
  for (const ContactRecord& record : records) {
    found +=
        static_cast<std::size_t>(std::ranges::count(contacts, record.key, &ReportedContact::key));
  }
  EXPECT_EQ(found, records.size());
}

/// Bodies of all kinds in one place, some of which touch themselves.
TEST(ContactNames, DifferForEveryPairOfKinds) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> range(-1, 1);
  const auto point = [&](double size) {
    return Point3{size * range(random), size * range(random), size * range(random)};
  };
  for (int trial = 0; trial < 24; ++trial) {
    PairScene scene;
    scene.scene.surfaces.thickness = std::pow(10, -2 - 3 * (trial % 4) / 3.0);
    const double size = trial < 12 ? 0.1 : 20 * scene.scene.surfaces.thickness;
    scene.add_plane(point(size), unit(point(1)));
    scene.add_plane(point(size), unit(point(1)));
    for (int b = 0; b < 10; ++b) {
      PairScene::Kind kind{.is_rigid = b % 2 == 0, .way = point(0.3 * size)};
      kind.touches_itself = !kind.is_rigid;
      if (b == 2 || b == 3) {
        kind.is_rigid = true;
        kind.touches_itself = false;
        scene.add_sphere(point(size), 0.3 * size, kind);
      } else if (b == 4 || b == 5) {
        kind.is_rigid = true;
        kind.touches_itself = false;
        const Point3 from = point(size);
        scene.add_capsule(from, plus(from, point(size)), 0.2 * size, kind);
      } else {
        Square grid = square(3, 0, true, size);
        for (Point3& x : grid.vertices) x = plus(x, point(0.2 * size));
        scene.add_mesh(grid.vertices, grid.triangles, kind);
      }
    }
    const auto& contacts = scene.contacts();
    EXPECT_GT(contacts.size(), 10U);
    expect_own_names(contacts);
    ContactTracker tracker;
    EXPECT_EQ(tracker.begin_step(contacts, scene.places(), 0.01).size(), contacts.size());
  }
}

TEST(ContactNames, OfClothOverABallLastForEveryThickness) {
  for (const double thickness : {3e-6, 3e-5, 3e-4, 3e-3}) {
    Body cloth = sheet_body("cloth", {1, 1}, {8, 8});
    cloth.geometry = Sheet{.size = {1, 1}, .cells = {8, 8}, .origin = {-0.45, -0.5, 0.33}};
    cloth.velocity = {1, 0, -3};
    Scene scene = scene_of({cloth}, 0.005);
    scene.thickness = thickness;
    scene.contact.material.friction = 0.3;
    scene.solver.linear_tolerance = 1e-6;
    scene.obstacles = {{"ball", SphereObstacle{{0, 0, 0}, 0.3}, {}, {}}};
    Simulator simulator(scene);
    for (int n = 0; n < 30; ++n) ASSERT_TRUE(simulator.step());
    EXPECT_GT(simulator.record().contacts, 3);
  }
}

}  // namespace
}  // namespace tetwarp::test

/// @file test_contact_large.cpp
/// Contact of many bodies and points, and laws that take long.
#include <gtest/gtest.h>

#include "tests/simulate/stress_watch.hpp"

namespace tetwarp::test {
namespace {

/// A cloth of n x n cells that falls on the floor: each of its points touches it.
Watch cloth_on_floor(std::int64_t n, int steps) {
  Body cloth = sheet_body("cloth", {1, 1}, {n, n});
  std::get<Sheet>(cloth.geometry).origin = {0, 0, 2e-4};
  cloth.self = false;
  Scene scene = floor_scene({cloth}, 0.005, 0.3);
  scene.solver.contact_tolerance = 1e-4;
  scene.solver.linear_tolerance = 1e-6;
  Simulator simulator(scene);
  return watch_steps(simulator, steps);
}

TEST(ContactLarge, ClothLiesOnAFloorWithTenThousandContacts) {
  const Watch watch = cloth_on_floor(100, 4);
  SCOPED_TRACE(testing::Message() << watch);
  EXPECT_TRUE(watch.is_finite);
  EXPECT_GT(watch.least_distance, 0);
  EXPECT_EQ(watch.most_contacts, 101 * 101);
}

/// A regular tetrahedron of circumradius r, turned by its number.
Body stone(int number, double r, const Point3& position) {
  Body body;
  body.name = "s" + std::to_string(number);
  body.kind = BodyKind::rigid;
  const double s = r / std::sqrt(3.0);
  body.geometry = Surface{{{s, s, s}, {s, -s, -s}, {-s, s, -s}, {-s, -s, s}},
                          {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}};
  body.rigid.density = 2500;
  const double angle = 0.7 * number;
  body.pose.rotation = {std::cos(angle), std::sin(angle), 0, 0};
  body.pose.position = position;
  return body;
}

Scene gravel(int across, int layers) {
  std::vector<Body> stones;
  const double pitch = 0.0202;
  for (int k = 0; k < layers; ++k) {
    for (int j = 0; j < across; ++j) {
      for (int i = 0; i < across; ++i) {
        stones.push_back(
            stone(static_cast<int>(stones.size()), 0.01,
                  {pitch * (i + 0.3 * (k % 2)), pitch * (j + 0.2 * (k % 3)), 0.0105 + pitch * k}));
      }
    }
  }
  Scene scene = floor_scene(std::move(stones), 0.004, 0.5);
  scene.solver.contact_tolerance = 1e-4;
  return scene;
}

TEST(ContactLarge, GravelOfTwentyThousandStonesSettles) {
  Simulator simulator(gravel(41, 12));
  const Watch watch = watch_steps(simulator, 30, 1000);
  SCOPED_TRACE(testing::Message() << watch);
  EXPECT_TRUE(watch.is_finite);
  EXPECT_GT(watch.least_distance, 0);
  EXPECT_GT(watch.most_contacts, 10'000);
}

}  // namespace
}  // namespace tetwarp::test

/// @file test_self_clearance.cpp
/// Sheets that hardly deform are not compared with themselves, and nothing is missed for it.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "tests/collide/brute_force_pairs.hpp"

namespace tetwarp::test {
namespace {

constexpr int cells = 5;

/// A sheet that touches itself, and one that does not, far away.
CollideScene sheets() {
  CollideScene scene;
  scene.surfaces.thickness = 1e-3;
  scene.add_sheet({0, 0, 0}, 1, cells, {.touches_itself = true});
  scene.add_sheet({0, 0, 9}, 1, 2);
  return scene;
}

/// Ends become starts.
void go_on(CollideScene& scene) {
  scene.motion.start = scene.motion.end;
}

TEST(SelfClearance, ASheetInFreeFlightIsComparedOnce) {
  std::mt19937 random(3);
  CollideScene scene = sheets();
  const auto detector = make_cpu_detector(scene.surfaces, {});
  for (int step = 0; step < 20; ++step) {
    scene.move_body(0, {0.02 * step, 0.01, -0.1 * step});
    scene.shake_body(0, 5e-4, random);
    detector->begin_step();
    EXPECT_TRUE(detector->detect(scene.motion).empty());
    EXPECT_EQ(detector->counts().pairs, 0) << step;
    go_on(scene);
  }
}

/// The sheet is rolled up ever more, flies and trembles: a detector that goes on from step to step
/// finds what a comparison of all pairs finds.
TEST(SelfClearance, NothingIsMissedWhereASheetFolds) {
  for (const unsigned seed : {1U, 2U}) {
    std::mt19937 random(seed);
    CollideScene scene = sheets();
    const std::vector<Point3> flat = scene.motion.start.vertices;
    const auto detector = make_cpu_detector(scene.surfaces, {.threads = 2});
    std::size_t touched = 0;
    for (int step = 0; step < 50; ++step) {
      // Still for some steps, then faster: known clearances last and end.
      const double turns = step < 15 ? 0.002 * step : 0.03 + 0.032 * (step - 15);
      for (std::int32_t v = 0; v < scene.surfaces.bodies[0].vertex_end; ++v) {
        const auto index = static_cast<std::size_t>(v);
        const double angle = 2 * std::acos(-1.0) * turns * flat[index][0];
        const double radius = turns > 0 ? 1 / (2 * std::acos(-1.0) * turns) : 0;
        scene.motion.end.vertices[index] = {
            turns > 0 ? radius * std::sin(angle) : flat[index][0], flat[index][1],
            (turns > 0 ? radius * (1 - std::cos(angle)) : 0) + 0.1 * step};
      }
      scene.shake_body(0, 2e-4, random);
      detector->begin_step();
      const auto found = detector->detect(scene.motion);
      EXPECT_EQ(found, detected_by_force(scene)) << step;
      touched += found.size();
      const ClosestPair nearest = detector->closest(scene.motion.end, 0.1);
      CollideScene after = scene;
      go_on(after);
      EXPECT_NEAR(nearest.distance, closest_by_force(after, 0.1).distance, 1e-13) << step;
      go_on(scene);
    }
    EXPECT_GT(touched, 0U);
  }
}

}  // namespace
}  // namespace tetwarp::test

/// @file test_detector_turns.cpp
/// The detector with bodies and planes that turn: all pairs are tested on the true ways.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/collide/brute_force_pairs.hpp"

namespace tetwarp::test {
namespace {

Point3 turned(const Point3& arm, const Point3& turn, double time) {
  const double angle = norm(turn);
  const Point3 axis = times(1 / angle, turn);
  const Point3 side = cross(axis, arm);
  return plus(plus(arm, times(std::sin(time * angle), side)),
              times(1 - std::cos(time * angle), cross(axis, side)));
}

/// All bodies turn about random axes through random points, and move.
void turn_bodies(CollideScene& scene, double angle, double way, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto vector = [&](double length) {
    const Point3 v{normal(random), normal(random), normal(random)};
    return times(length / norm(v), v);
  };
  SurfaceMotion& motion = scene.motion;
  motion.frames.resize(scene.surfaces.bodies.size());
  for (std::size_t b = 0; b < motion.frames.size(); ++b) {
    const Point3 center = vector(0.3), go = vector(way), turn = vector(angle);
    for (std::size_t i = 0; i < 3; ++i) {
      motion.frames[b].center[i] = center[i];
      motion.frames[b].motion[i] = go[i];
      motion.frames[b].turn[i] = turn[i];
    }
    const auto place = [&](const Point3& x) {
      return plus(plus(center, go), turned(minus(x, center), turn, 1));
    };
    const CollisionBody& body = scene.surfaces.bodies[b];
    for (auto v = static_cast<std::size_t>(body.first_vertex);
         v < static_cast<std::size_t>(body.vertex_end); ++v) {
      const Point3& x = motion.start.vertices[v];
      motion.end.vertices[v] = place(x);
      motion.sagitta[v] = norm(cross(turn, minus(x, center))) * angle / 8;
    }
    for (auto p = static_cast<std::size_t>(body.first_plane);
         p < static_cast<std::size_t>(body.plane_end); ++p) {
      const PlanePlace& start = motion.start.planes[p];
      motion.end.planes[p] = {place(start.point), turned(start.normal, turn, 1)};
    }
  }
}

class DetectorTurns : public testing::TestWithParam<double> {};

TEST_P(DetectorTurns, PairsAreThoseOfAllPairs) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    CollideScene scene = mixed_scene(seed, 0);
    turn_bodies(scene, GetParam(), 0.05, seed);
    const auto detector = make_cpu_detector(scene.surfaces, {});

    const std::vector<TouchingPair> found = detector->detect(scene.motion);

    EXPECT_GT(found.size(), 50u);
    EXPECT_EQ(found, detected_by_force(scene));
    EXPECT_EQ(detector->check(scene.motion), checked_by_force(scene));
  }
}
INSTANTIATE_TEST_SUITE_P(Angles, DetectorTurns, testing::Values(0.01, 0.3, 1.0));

/// A plate spins on a floor at the thickness: its corners' sagitta is 25 times that, and yet
/// nothing stops it.
TEST(DetectorSpin, ASpinningPlateAtRestIsNotStopped) {
  CollideScene scene;
  scene.surfaces.thickness = 1e-4;
  scene.add_sheet({-1, -1, 0}, 2, 2, {.has_unknowns = false});
  scene.add_sheet({-0.5, -0.5, 1e-4}, 1, 3);
  turn_bodies(scene, 0.17, 0, 1);
  scene.motion.end = scene.motion.start;
  scene.motion.frames[0] = {};
  scene.motion.frames[1] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0.17}};
  for (std::size_t v = 0; v < scene.motion.sagitta.size(); ++v) {
    const bool spins = scene.surfaces.vertex_body[v] == 1;
    const Point3& x = scene.motion.start.vertices[v];
    if (spins) scene.motion.end.vertices[v] = turned(x, {0, 0, 0.17}, 1);
    scene.motion.sagitta[v] = spins ? std::hypot(x[0], x[1]) * 0.17 * 0.17 / 8 : 0;
  }
  const auto detector = make_cpu_detector(scene.surfaces, {});

  EXPECT_EQ(detector->check(scene.motion).size(), 0u);
  scene.motion.frames.clear();
  EXPECT_GT(detector->check(scene.motion).size(), 0u);
}

TEST(DetectorSpin, FramesOfTheWrongNumberAreRefused) {
  CollideScene scene = mixed_scene(1, 0);
  scene.motion.frames.resize(2);
  const auto detector = make_cpu_detector(scene.surfaces, {});

  EXPECT_THROW(detector->detect(scene.motion), std::invalid_argument);
}

}  // namespace
}  // namespace tetwarp::test

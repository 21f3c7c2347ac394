/// @file test_surface_motion.cpp
/// Surfaces move as the bodies do; turning vertices stay within the sagitta of their chords.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "host/simulate/model/body_points.hpp"
#include "host/simulate/model/rotations.hpp"
#include "host/simulate/step/scene_drive.hpp"
#include "host/simulate/surfaces/surface_motion.hpp"
#include "tests/simulate/touch_scenes.hpp"

namespace tetwarp::test {
namespace {

/// All bodies after a part of a step, straight from the equations.
ModelState moved_state(const Model& model,
                       const ModelState& state,
                       const std::vector<Point3>& velocity,
                       double seconds) {
  ModelState moved = state;
  for (std::size_t n = 0; n < static_cast<std::size_t>(model.node_count); ++n) {
    moved.position[n] = plus(state.position[n], times(seconds, velocity[n]));
  }
  for (std::size_t r = 0; r < state.rotation.size(); ++r) {
    const std::size_t block = static_cast<std::size_t>(model.node_count) + 2 * r;
    const std::size_t center = static_cast<std::size_t>(model.node_count) + r;
    moved.position[center] = plus(state.position[center], times(seconds, velocity[block]));
    moved.rotation[r] =
        product(quaternion_of(times(seconds, velocity[block + 1])), state.rotation[r]);
  }
  return moved;
}

Scene moving_scene() {
  Body elastic = elastic_box("elastic", {0.1, 0.1, 0.1}, {2, 2, 2});
  elastic.surface = std::int64_t{100};
  Body sheet = sheet_body("sheet", {0.3, 0.2}, {30, 20});
  sheet.pose.position = {0, 0, 2};
  Scene scene =
      scene_of({elastic, rigid_box("box", {0.1, 0.2, 0.1}, {-1, 0, 0}), sheet,
                rigid_ball("ball", 0.3, {0, 5, 0}), rigid_capsule("pill", 0.1, 0.4, {0, -5, 0})},
               0.01);
  scene.obstacles = {{"floor", PlaneObstacle{{0, 1, 2}, {0, 0, -4}}, {}, {}},
                     {"bar",
                      CapsuleObstacle{{0, 0, -7}, {1, 0, -7}, 0.2},
                      {},
                      {{0, Point3{0, 0, 1}, {0.1, 0, 0}}}}};
  return scene;
}

std::vector<Point3> random_velocity(const Model& model, double speed) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> any(-speed, speed);
  std::vector<Point3> velocity(static_cast<std::size_t>(model.block_count()));
  for (Point3& v : velocity) v = {any(random), any(random), any(random)};
  return velocity;
}

SurfaceMotion motion_of(const TouchScene& touch,
                        const std::vector<Point3>& velocity,
                        double time_step,
                        const std::vector<double>& fraction,
                        int threads = 1) {
  return test::motion_of(
      {touch.surfaces, touch.model, touch.model.start, velocity, time_step, fraction}, threads);
}

TEST(SurfaceMotion, EndsWhereTheMovedBodiesAre) {
  const TouchScene touch(moving_scene());
  for (const double speed : {0.0, 1.0, 300.0}) {
    const std::vector<Point3> velocity = random_velocity(touch.model, speed);
    const SurfaceMotion motion = motion_of(touch, velocity, 0.01, {});
    const ModelState end = moved_state(touch.model, touch.model.start, velocity, 0.01);
    for (std::size_t v = 0; v < motion.end.vertices.size(); ++v) {
      const Point3 exact = position_of(touch.surfaces.vertex_point[v], end, touch.model.node_count);
      ASSERT_LT(norm(minus(motion.end.vertices[v], exact)), 1e-12);
    }
    const std::int32_t frame = touch.surfaces.plane_rigid[0];
    const Point3 normal = rotate(at(end.rotation, frame), unit(Point3{0, 1, 2}));
    EXPECT_LT(norm(minus(motion.end.planes[0].normal, normal)), 1e-14);
    const Point3 point = plus(at(end.position, touch.model.node_count + frame),
                              rotate(at(end.rotation, frame), {0, 0, -4}));
    EXPECT_LT(norm(minus(motion.end.planes[0].point, point)), 1e-12);
  }
}

/// What rests has a motion of the same bits at start and end.
TEST(SurfaceMotion, OfRestIsExact) {
  const TouchScene touch(moving_scene());
  const SurfaceMotion rest = motion_of(touch, random_velocity(touch.model, 0), 0.01, {});
  const SurfaceMotion held =
      motion_of(touch, random_velocity(touch.model, 9), 0.01, std::vector<double>(7, 0.0));
  for (const SurfaceMotion& motion : {rest, held}) {
    EXPECT_EQ(motion.start.vertices, motion.end.vertices);
    EXPECT_EQ(motion.start.planes[0].normal, motion.end.planes[0].normal);
    EXPECT_EQ(*std::max_element(motion.sagitta.begin(), motion.sagitta.end()), 0);
  }
}

TEST(SurfaceMotion, EachBodyMovesByItsFraction) {
  const TouchScene touch(moving_scene());
  const std::vector<Point3> velocity = random_velocity(touch.model, 30);
  const std::vector<double> fraction{1, 0.25, 0.5, 0, 0.75, 0.125, 1};
  const SurfaceMotion motion = motion_of(touch, velocity, 0.01, fraction);
  for (std::size_t v = 0; v < motion.end.vertices.size(); ++v) {
    const auto body = static_cast<std::size_t>(touch.surfaces.surfaces.vertex_body[v]);
    const ModelState end =
        moved_state(touch.model, touch.model.start, velocity, 0.01 * fraction[body]);
    const Point3 exact = position_of(touch.surfaces.vertex_point[v], end, touch.model.node_count);
    ASSERT_LT(norm(minus(motion.end.vertices[v], exact)), 1e-12);
  }
}

/// Sources: the motion at 16 instants. The largest deviation is close to the bound for small
/// turns, so that the bound is not loose.
TEST(SurfaceMotion, TurningVerticesStayWithinTheSagitta) {
  const TouchScene touch(moving_scene());
  for (const double turn : {0.01, 0.3, 1.0, 3.0, 7.0, 40.0}) {
    std::vector<Point3> velocity = random_velocity(touch.model, 3);
    for (std::int32_t r = 0; r < touch.model.rigid_count; ++r) {
      Point3& spin = velocity[static_cast<std::size_t>(touch.model.node_count + 2 * r) + 1];
      spin = times(turn / 0.01, unit(spin));
    }
    const SurfaceMotion motion = motion_of(touch, velocity, 0.01, {});
    double closest = 0;
    for (int instant = 1; instant < 16; ++instant) {
      const double u = instant / 16.0;
      const ModelState now = moved_state(touch.model, touch.model.start, velocity, 0.01 * u);
      for (std::size_t v = 0; v < motion.sagitta.size(); ++v) {
        const Point3 x = position_of(touch.surfaces.vertex_point[v], now, touch.model.node_count);
        const Point3 chord =
            plus(times(1 - u, motion.start.vertices[v]), times(u, motion.end.vertices[v]));
        const double deviation = norm(minus(x, chord));
        ASSERT_LE(deviation, motion.sagitta[v] + 1e-13) << turn;
        if (motion.sagitta[v] > 0) closest = std::max(closest, deviation / motion.sagitta[v]);
      }
    }
    if (turn <= 0.3) {
      EXPECT_GT(closest, 0.99) << turn;
    }
  }
}

/// A sphere that turns about its center does not move; a capsule that turns about its axis neither.
TEST(SurfaceMotion, OnTheAxisTheSagittaIsZero) {
  const TouchScene touch(moving_scene());
  std::vector<Point3> velocity(static_cast<std::size_t>(touch.model.block_count()), {0, 0, 0});
  for (std::int32_t r = 0; r < touch.model.rigid_count; ++r) {
    velocity[static_cast<std::size_t>(touch.model.node_count + 2 * r) + 1] = {0, 0, 50};
  }
  const SurfaceMotion motion = motion_of(touch, velocity, 0.01, {});
  for (std::size_t body = 3; body < 5; ++body) {
    for (std::int32_t v = touch.body(body).first_vertex; v < touch.body(body).vertex_end; ++v) {
      EXPECT_LT(at(motion.sagitta, v), 1e-15);
      EXPECT_LT(norm(minus(at(motion.start.vertices, v), at(motion.end.vertices, v))), 1e-14);
    }
  }
}

TEST(SurfaceMotion, ThreadsGiveTheSameBits) {
  const TouchScene touch(moving_scene());
  const std::vector<Point3> velocity = random_velocity(touch.model, 30);
  const SurfaceMotion one = motion_of(touch, velocity, 0.01, {}),
                      many = motion_of(touch, velocity, 0.01, {}, 7);
  EXPECT_EQ(one.start.vertices, many.start.vertices);
  EXPECT_EQ(one.end.vertices, many.end.vertices);
  EXPECT_EQ(one.sagitta, many.sagitta);
}

TEST(MovingObstacles, StartWhereTheirPathDoes) {
  const TouchScene touch(moving_scene());
  EXPECT_EQ(touch.model.rigid_count, 5);
  EXPECT_EQ(touch.surfaces.body_rigid, (std::vector<std::int32_t>{-1, 0, -1, 1, 2, 3, 4}));
  SurfacePlaces places;
  surface_places(touch.surfaces, touch.model, touch.model.start, 1, places);
  const auto bar = static_cast<std::size_t>(touch.body(6).first_vertex);
  const Point3 exact{0, 7 * std::sin(0.1), 1 - 7 * std::cos(0.1)};
  EXPECT_LT(norm(minus(places.vertices[bar], exact)), 1e-14);
}

/// Paths move obstacles; a tool moves every obstacle, whether it has a path or not.
TEST(MovingObstacles, FollowPathsAndTools) {
  Scene scene = scene_of({rigid_ball("ball", 0.1, {0, 0, 9})}, 0.01);
  scene.obstacles = {{"still", SphereObstacle{{1, 0, 0}, 0.1}, {}, {}},
                     {"lift",
                      PlaneObstacle{{0, 0, 1}, {0, 0, -1}},
                      {},
                      {{0, Point3{0, 0, 0}}, {1, Point3{0, 0, 1}}}}};
  const TouchScene touch(scene);
  SceneDrive drive(touch.scene, touch.geometry, touch.model);
  drive.move_script("still", {{0, 2, 0}, {0, 0, 1}});
  StepInput input;
  drive.fill(touch.model.start, 0.5, 0.01, input);
  const SurfaceMotion motion = motion_of(touch, input.prescribed_velocity, 0.01, {});

  const auto ball = static_cast<std::size_t>(touch.body(1).first_vertex);
  EXPECT_EQ(motion.start.vertices[ball], (Point3{1, 0, 0}));
  EXPECT_LT(norm(minus(motion.end.vertices[ball], {std::cos(1), 2 + std::sin(1), 0})), 1e-13);
  EXPECT_NEAR(motion.sagitta[ball], 1.0 / 8, 1e-14);
  EXPECT_LT(norm(minus(motion.end.planes[0].point, {0, 0, -0.5})), 1e-14);
  EXPECT_EQ(motion.end.planes[0].normal, (Point3{0, 0, 1}));
}

/// The steppers take scenes with obstacles that nothing is coupled to.
TEST(MovingObstacles, HaveFramesOnAllBackEnds) {
  Scene scene = scene_of({rigid_ball("ball", 0.1, {0, 0, 9})}, 0.01);
  scene.obstacles = {{"still", SphereObstacle{{1, 0, 0}, 0.1}, {}, {}},
                     {"floor", PlaneObstacle{{0, 0, 1}, {0, 0, -1}}, {}, {}}};
  for (const Backend backend : {Backend::cpu, Backend::reference}) {
    SimulateOptions options;
    options.backend = backend;
    Simulator simulator(scene, options);
    simulator.move_script("floor", {0, 0, 1}, {0, 0.1, 0});
    simulator.step();
    simulator.step();
    // After two steps of backward Euler: 9 - g dt^2 (1 + 2)
    EXPECT_NEAR(simulator.record().bodies[0].center[2], 9 - 9.81 * 3e-4, 1e-12);
  }
}

}  // namespace
}  // namespace tetwarp::test

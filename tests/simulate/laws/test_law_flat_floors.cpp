/// @file test_law_flat_floors.cpp
/// Bodies that slide on and land on flat floors made of triangles: what a plane would do to them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "host/base/point3.hpp"
#include "host/scene/shapes/shape_surface.hpp"
#include "host/simulate/model/rotations.hpp"
#include "tests/simulate/law_scenes.hpp"

namespace tetwarp::test {
namespace {

/// Numbers from -1 to 1, the same on every machine.
class Noise {
 public:
  explicit Noise(unsigned seed) : random_(seed) {}
  double operator()() { return static_cast<double>(random_() >> 11) * 0x1p-52 - 1; }
  Point3 direction() {
    const double x = (*this)(), y = (*this)(), z = (*this)();
    return unit(Point3{x, y, z});
  }

 private:
  std::mt19937_64 random_;
};

/// nx x ny cells of two triangles each on z = 0, whose inner vertices are displaced at
/// random.
Surface random_floor(const Point3& low, const Point3& high, int nx, int ny, Noise& noise) {
  Surface floor;
  for (int j = 0; j <= ny; ++j) {
    for (int i = 0; i <= nx; ++i) {
      const double x = i + (i > 0 && i < nx ? 0.4 * noise() : 0);
      const double y = j + (j > 0 && j < ny ? 0.4 * noise() : 0);
      floor.points.push_back(
          {low[0] + (high[0] - low[0]) * x / nx, low[1] + (high[1] - low[1]) * y / ny, 0});
    }
  }
  for (std::int32_t j = 0; j < ny; ++j) {
    for (std::int32_t i = 0; i < nx; ++i) {
      const std::int32_t a = j * (nx + 1) + i, b = a + 1, c = a + nx + 1, d = c + 1;
      if (noise() < 0) {
        floor.triangles.insert(floor.triangles.end(), {{a, b, d}, {a, d, c}});
      } else {
        floor.triangles.insert(floor.triangles.end(), {{a, b, c}, {b, d, c}});
      }
    }
  }
  return floor;
}

/// The surface of a box between two corners.
Surface box_surface(const Point3& low, const Point3& high) {
  Surface box;
  for (int v = 0; v < 8; ++v) {
    box.points.push_back({(v & 1) != 0 ? high[0] : low[0], (v & 2) != 0 ? high[1] : low[1],
                          (v & 4) != 0 ? high[2] : low[2]});
  }
  box.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return box;
}

enum class Floor { mesh, fine_mesh, slivers, slab, tiles, dome };
constexpr std::array floors{Floor::mesh, Floor::fine_mesh, Floor::slivers, Floor::slab,
                            Floor::tiles};

/// Adds a floor whose top is z = 0 around the origin.
/// @param widest  seam between tiles [thicknesses]
void add_floor(Floor kind, double widest, Scene& scene, Noise& noise) {
  const Point3 low{-1.3, -1.4, 0}, high{1.4, 1.3, 0};
  const auto add = [&](const Surface& surface) {
    scene.obstacles.push_back(
        {.name = "floor_" + std::to_string(scene.obstacles.size()), .geometry = surface});
  };
  if (kind == Floor::mesh) return add(random_floor(low, high, 3, 2, noise));
  if (kind == Floor::fine_mesh) return add(random_floor(low, high, 37, 41, noise));
  if (kind == Floor::slivers) return add(random_floor(low, high, 200, 1, noise));
  if (kind == Floor::dome) {  // of 200 m radius
    Surface dome = random_floor(low, high, 60, 60, noise);
    for (Point3& x : dome.points) x[2] = -(x[0] * x[0] + x[1] * x[1]) / 400;
    return add(dome);
  }
  if (kind == Floor::slab) {
    Body slab = rigid_box("slab", {1.4, 1.4, 0.1}, {0, 0, -0.1});
    slab.kind = BodyKind::scripted;
    scene.bodies.push_back(slab);
    return;
  }
  const double seam = 0.5 * (1 + noise()) * widest * *scene.thickness;
  for (int i = -6; i < 6; ++i) {
    for (int j = -1; j < 1; ++j) {
      add(box_surface({0.21 * i + 0.03, 1.1 * j + 0.07, -0.1},
                      {0.21 * i + 0.24 - seam, 1.1 * j + 1.17 - seam, 0}));
    }
  }
}

/// Turns all of a scene about the origin.
void turn(Scene& scene, const Quaternion& by) {
  scene.gravity = rotate(by, scene.gravity);
  for (Body& body : scene.bodies) {
    body.pose.position = rotate(by, body.pose.position);
    body.pose.rotation = product(by, body.pose.rotation);
    body.velocity = rotate(by, body.velocity);
  }
  for (Obstacle& obstacle : scene.obstacles) {
    for (Point3& x : std::get<Surface>(obstacle.geometry).points) x = rotate(by, x);
  }
}

Quaternion turn_about(const Point3& axis, double angle) {
  const Point3 a = times(std::sin(angle / 2) / norm(axis), axis);
  return {std::cos(angle / 2), a[0], a[1], a[2]};
}

/// Above the origin, turned about z by `yaw`, the lowest point `height` above the floor.
struct Start {
  double yaw = 0, height = 1.1e-4;
  Point3 velocity{0, 0, 0};
};
void put(Body& body, double lowest, const Start& start) {
  body.pose = {{0, 0, start.height - lowest}, turn_about({0, 0, 1}, start.yaw)};
  body.velocity = start.velocity;
}

Body box_above(const Start& start) {
  const Point3 half{0.06, 0.05, 0.03};
  Body box = rigid_box("body", half, {});
  box.geometry = box_surface(times(-1, half), half);
  put(box, -half[2], start);
  return box;
}

struct Slide {
  double along = 0;    ///< speed along the floor at the end [m/s]
  double way = 0;      ///< along the floor [m]
  double height = 0;   ///< of the center above that of rest, at the end [m]
  double leaning = 0;  ///< largest part of a step's contact force that is not normal to the floor
  std::int64_t clamped = 0;
};

/// Steps a scene whose body 0 is above a floor that is turned by `tilt`.
Slide slide(const Scene& scene, const Quaternion& tilt, int steps) {
  Simulator simulator(scene);
  const Point3 up = rotate(tilt, {0, 0, 1});
  const Point3 start = simulator.record().bodies[0].center;
  Slide result;
  for (int n = 0; n < steps; ++n) {
    simulator.step();
    const StepRecord& record = simulator.record();
    const Point3 force = record.bodies[0].contact_force;
    const double normal = dot(force, up);
    if (norm(force) > 0) {
      result.leaning =
          std::max(result.leaning, norm(minus(force, times(normal, up))) / std::abs(normal));
    }
    result.clamped += record.clamped_islands;
  }
  const BodyRecord& end = simulator.record().bodies[0];
  const auto along_floor = [&](const Point3& x) { return norm(minus(x, times(dot(x, up), up))); };
  result.along = along_floor(end.velocity);
  result.way = along_floor(minus(end.center, start));
  result.height = dot(minus(end.center, start), up);
  return result;
}

Scene sliding_scene(const Body& body, double time_step, double friction) {
  Scene scene = scene_of({body}, time_step);
  scene.thickness = 1e-4;
  scene.contact.material.friction = friction;
  return scene;
}

/// Without friction all contacts of a body with a flat floor push along its normal, so that the
/// body keeps its speed along the floor.
TEST(FlatFloor, WithoutFrictionPushesAlongItsNormalOnly) {
  Noise noise(7);
  for (int k = 0; k < 40; ++k) {
    const Floor floor = floors[static_cast<std::size_t>(k) % floors.size()];
    const double time_step = std::pow(10, -3 + 1.15 * (1 + noise()) / 2);  // 1 to 14 ms
    const double speed = std::pow(10, 0.7 * noise());                      // 0.2 to 5 m/s
    const double direction = 3 * noise();
    Start start{3 * noise(), 1.1e-4, {speed * std::cos(direction), speed * std::sin(direction), 0}};
    if (k % 2 == 1) start.height = 3e-3, start.velocity[2] = -0.5 * (1 + noise());
    const Quaternion tilt = turn_about(noise.direction(), 3 * noise());
    Scene scene = sliding_scene(box_above(start), time_step, 0);
    add_floor(floor, 2, scene, noise);
    turn(scene, tilt);
    const Slide end = slide(scene, tilt, static_cast<int>(std::min(40.0, 1 / (speed * time_step))));
    EXPECT_LT(end.leaning, 1e-9) << k;
    EXPECT_NEAR(end.along, speed, 1e-6 * speed) << k;
    EXPECT_EQ(end.clamped, 0) << k;
  }
}

/// Backward Euler stops a body within v^2 / (2 mu g) - v dt / 2, on any floor.
TEST(FlatFloor, WithFrictionStopsABoxWhereAPlaneDoes) {
  Noise noise(8);
  const double speed = 1, friction = 0.4;
  for (const Floor floor : floors) {
    for (const double time_step : {2e-3, 1e-2}) {
      const Body box = box_above({.yaw = 0.3, .velocity = {speed, 0, 0}});
      Scene scene = sliding_scene(box, time_step, friction);
      add_floor(floor, 2, scene, noise);
      const double expected = speed * speed / (2 * friction * earth) - speed * time_step / 2;
      const Slide end = slide(scene, {1, 0, 0, 0}, static_cast<int>(0.3 / time_step));
      EXPECT_NEAR(end.way, expected, 0.01 * expected) << static_cast<int>(floor);
      EXPECT_LT(end.along, 1e-5);
      EXPECT_NEAR(end.height, 0, 1e-4);
    }
  }
}

/// Bodies that change their shape, and round ones, keep their speed too, also on a dome so flat
/// that gravity does not change it by more. Seams are narrow: between the edges of wide ones a
/// single vertex sinks in.
TEST(FlatFloor, DoesNotSlowDownBodiesOfOtherKinds) {
  Noise noise(9);
  Body soft_box = elastic_box("body", {0.06, 0.05, 0.03}, {3, 3, 2});
  Body soft_ball = elastic_ball("body", 0.05, 150, {});
  soft_ball.surface = make_shape_surface(EllipsoidShape{{0.05, 0.05, 0.05}}, 320);
  Body cloth = sheet_body("body", {0.2, 0.15}, {8, 6});
  Body ball = exact_ball("body", 0.05, {});
  Body facets = ball;
  facets.geometry = make_shape_surface(EllipsoidShape{{0.05, 0.05, 0.05}}, 320);
  const std::vector<std::pair<Body, double>> bodies{
      {soft_box, -0.03}, {soft_ball, -0.05}, {cloth, 0}, {ball, -0.05}, {facets, -0.05}};
  constexpr double hit_sine = 0.0088;  // by which the normal of a hit may lean
  std::vector<Floor> all(floors.begin(), floors.end());
  all.push_back(Floor::dome);
  for (const Floor floor : all) {
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      for (const double fall : {0.0, 0.3}) {
        const double speed = fall > 0 ? 0.47 : 1.5, time_step = fall > 0 ? 9e-3 : 4e-3;
        Body own = bodies[b].first;
        put(own, bodies[b].second, {0.4, fall > 0 ? 2e-3 : 1.1e-4, {speed, 0.1 * speed, -fall}});
        Scene scene = sliding_scene(own, time_step, 0);
        add_floor(floor, 0.02, scene, noise);
        const Slide end = slide(scene, {1, 0, 0, 0}, 40);
        const double start = std::hypot(speed, 0.1 * speed);
        const double lost = floor == Floor::dome ? 3e-2 * start : 1e-3 * start + hit_sine * fall;
        EXPECT_NEAR(end.along, start, lost) << static_cast<int>(floor) << " " << b << " " << fall;
        EXPECT_EQ(end.clamped, 0);
      }
    }
  }
}

/// A box that slides over the edge of a slab tips, leaves it and falls, however it is turned: its
/// edges touch that of the slab while it tips.
TEST(FlatFloor, EndsAtItsEdge) {
  Noise noise(10);
  for (int k = 0; k < 12; ++k) {
    const double speed = 0.7, time_step = k % 2 == 0 ? 5e-3 : 2e-3;
    Scene scene =
        sliding_scene(box_above({.yaw = 3 * noise(), .velocity = {speed, 0, 0}}), time_step, 0.1);
    add_floor(k % 3 == 0 ? Floor::mesh : Floor::slab, 0, scene, noise);
    scene.bodies[0].pose.position[0] = 1.3;
    const Slide end = slide(scene, {1, 0, 0, 0}, static_cast<int>(1 / time_step));
    EXPECT_LT(end.height, -0.4) << k;
    EXPECT_EQ(end.clamped, 0) << k;
  }
}

/// A soft slab, whose upper side is uneven where a body presses, on fixed nodes.
TEST(FlatFloor, OfASoftSlabDoesNotStopABox) {
  for (const double friction : {0.0, 0.4}) {
    const double speed = 1, time_step = 5e-3;
    const Body box = box_above({.yaw = 0.3, .velocity = {speed, 0, 0}});
    Scene scene = sliding_scene(box, time_step, friction);
    Body slab = elastic_box("slab", {0.5, 0.15, 0.03}, {20, 6, 1});
    slab.pose.position = {0.3, 0, -0.03};
    slab.material.youngs_modulus = 1e7;
    slab.fixed = {HalfSpaceSelection{{0, 0, -1}, 0.0599}};
    scene.bodies.push_back(slab);
    const Slide end = slide(scene, {1, 0, 0, 0}, 60);
    const double way = speed * speed / (2 * friction * earth) - speed * time_step / 2;
    if (friction > 0) {
      EXPECT_NEAR(end.way, way, 0.02 * way);
    } else {
      EXPECT_NEAR(end.along, speed, 5e-3 * speed);
    }
  }
}

}  // namespace
}  // namespace tetwarp::test

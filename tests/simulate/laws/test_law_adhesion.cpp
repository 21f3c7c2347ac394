/// @file test_law_adhesion.cpp
/// Adhesion through whole steps: the force of a pull, and the pressure that bonds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/simulate/law_scenes.hpp"

namespace tetwarp::test {
namespace {

/// A closed box whose bottom and top are n x n squares, its half edges as given.
Surface divided_box(const Point3& half, int n) {
  Surface box;
  std::vector<std::int32_t> index(static_cast<std::size_t>((n + 1) * (n + 1) * 2));
  const auto id = [&](int i, int j, int k) {
    return static_cast<std::int32_t>((k * (n + 1) + j) * (n + 1) + i);
  };
  for (int k = 0; k < 2; ++k) {
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) {
        box.points.push_back(
            {half[0] * (2. * i / n - 1), half[1] * (2. * j / n - 1), half[2] * (2. * k - 1)});
      }
    }
  }
  const auto quad = [&](std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) {
    box.triangles.push_back({a, b, c});
    box.triangles.push_back({a, c, d});
  };
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      quad(id(i, j, 0), id(i, j + 1, 0), id(i + 1, j + 1, 0), id(i + 1, j, 0));
      quad(id(i, j, 1), id(i + 1, j, 1), id(i + 1, j + 1, 1), id(i, j + 1, 1));
    }
  }
  for (int i = 0; i < n; ++i) {
    quad(id(i, 0, 0), id(i + 1, 0, 0), id(i + 1, 0, 1), id(i, 0, 1));
    quad(id(i + 1, n, 0), id(i, n, 0), id(i, n, 1), id(i + 1, n, 1));
    quad(id(0, i + 1, 0), id(0, i, 0), id(0, i, 1), id(0, i + 1, 1));
    quad(id(n, i, 0), id(n, i + 1, 0), id(n, i + 1, 1), id(n, i, 1));
  }
  return box;
}

/// The largest force on the way of a rigid block that a spring pulls off a floor it is stuck to.
double pull_off_force(int n) {
  Body block = rigid_box("block", {0.1, 0.1, 0.05}, {0, 0, 0.05 + 1e-4});
  block.geometry = divided_box({0.1, 0.1, 0.05}, n);
  block.rigid.density = 250;
  block.damping.alpha = 20;
  Scene scene = floor_scene({block}, 0.002, 0);
  scene.gravity = {0, 0, 0};
  scene.contact.material.adhesion =
      AdhesionMaterial{.stiffness = 8e4, .energy = 2, .viscosity = 1e-5, .initial_intensity = 1};
  scene.handles = {{.body = "block",
                    .select = {AllSelection{}},
                    .stiffness = 1e4,
                    .path = {{0, Point3{0, 0, 0}}, {0.8, Point3{0, 0, 0.0088}}}}};
  Simulator simulator(scene);
  double force = 0;
  for (int n_step = 0; n_step < 400; ++n_step) {
    simulator.step();
    force = std::max(force, -simulator.record().bodies[0].contact_force[2]);
  }
  // Beyond the onset the intensity is W / (C g^2).
  const double gap = simulator.record().bodies[0].center[2] - 0.05 - 1e-4;
  EXPECT_NEAR(simulator.record().adhered_area / (0.04 * 2 / (8e4 * gap * gap)), 1, 0.01) << n;
  return force;
}

/// Area times sqrt(energy stiffness), however many points carry it.
TEST(PullOff, ForceIsAreaTimesTheRootOfEnergyAndStiffness) {
  const double expected = 0.2 * 0.2 * std::sqrt(2 * 8e4);
  for (const int n : {1, 2, 4, 8}) {
    EXPECT_NEAR(pull_off_force(n) / expected, 1, 0.01) << n;
  }
}

constexpr double bonding_rate = 2.5e-3, saturation = 4000;  ///< [1/(Pa s)], [Pa]

Body cube(const std::string& name, BodyKind kind, double height, double angle) {
  Body body = kind == BodyKind::rigid ? rigid_box(name, {0.1, 0.1, 0.1}, {0, 0, height})
                                      : elastic_box(name, {0.1, 0.1, 0.1}, {2, 2, 2});
  body.pose = {{0, 0, height}, {std::cos(angle / 2), 0, 0, std::sin(angle / 2)}};
  if (kind == BodyKind::rigid) body.rigid.density = 1000;
  if (kind == BodyKind::fem) body.material = {1e7, 0.3, 1000};
  return body;
}

constexpr AdhesionMaterial sticky{.stiffness = 1e6,
                                  .energy = 1,
                                  .viscosity = 0.05,
                                  .bonding_rate = bonding_rate,
                                  .saturation_pressure = saturation};

/// The bonded area after 0.2 s.
double bonded_area(Scene scene) {
  Simulator simulator(scene);
  while (simulator.time() < 0.2 - scene.time_step / 2) simulator.step();
  return simulator.record().adhered_area;
}

/// beta' = r (p - beta p_0) of a force A p on an area A ends at A p / p_0 (1 - exp(-r p_0 t)).
double bonded_by(double force) {
  return force / saturation * (1 - std::exp(-bonding_rate * saturation * 0.2));
}

/// Of bodies on a floor; only the last one, named upper, bonds, with what is below it.
Scene bonding_scene(std::vector<Body> bodies, double time_step, double tolerance) {
  const std::string below = bodies.size() > 1 ? bodies.front().name : "floor";
  Scene scene = floor_scene(std::move(bodies), time_step, 0.3);
  scene.thickness = 2e-5;
  scene.solver.contact_tolerance = tolerance;
  scene.contact.pairs = {{.a = below, .b = "upper", .has_adhesion = true, .adhesion = sticky}};
  return scene;
}

constexpr double cube_weight = earth * 1000 * 0.008;

/// Whichever contacts carry it.
TEST(Bonding, IsThatOfTheWeight) {
  for (const BodyKind kind : {BodyKind::rigid, BodyKind::fem}) {
    for (const double tolerance : {1e-4, 1e-7}) {
      for (const double time_step : {5e-3, 2.5e-3}) {
        const Body body = cube("upper", kind, 0.1 + 2e-5, 0);
        const double area = bonded_area(bonding_scene({body}, time_step, tolerance));
        // A step or two pass before the body rests.
        EXPECT_NEAR(area / bonded_by(cube_weight), 1, 0.01)
            << static_cast<int>(kind) << " " << tolerance << " " << time_step;
      }
    }
  }
}

/// Whatever bodies touch, however they are turned.
TEST(Bonding, IsThatOfTheWeightBetweenBodies) {
  for (const BodyKind lower : {BodyKind::rigid, BodyKind::fem}) {
    for (const BodyKind upper : {BodyKind::rigid, BodyKind::fem}) {
      for (const double angle : {0.0, 0.3, 0.785}) {
        const bool is_coarse = lower == BodyKind::fem && upper == BodyKind::fem && angle > 0.5;
        const double area = bonded_area(bonding_scene(
            {cube("lower", lower, 0.1 + 2e-5, 0), cube("upper", upper, 0.3 + 4e-5, angle)}, 5e-3,
            1e-5));
        EXPECT_NEAR(area / bonded_by(cube_weight), 1, is_coarse ? 0.1 : 0.01)
            << static_cast<int>(lower) << " under " << static_cast<int>(upper) << " " << angle;
      }
    }
  }
}

/// A load beside the center presses unevenly, and at no point by less than nothing.
TEST(Bonding, OfARigidBodyIsNoMoreThanThatOfItsLoadWhereverItActs) {
  for (const double slope : {0.2, 0.5, 0.8}) {
    Scene scene = bonding_scene({cube("upper", BodyKind::rigid, 0.1 + 2e-5, 0)}, 5e-3, 1e-6);
    scene.contact.pairs[0].friction = 2;
    scene.gravity = {slope * earth, 0, -earth};
    EXPECT_NEAR(bonded_area(scene) / bonded_by(cube_weight), 1, 0.01) << slope;
  }
}

/// A box beside a wall that carries nothing, both of one obstacle: edges touch both.
TEST(Bonding, OfOneAreaIsNotThatOfAnotherThatFacesElsewhere) {
  const double height = 0.1 + 2e-5, side = 0.1 + 2e-5 + 1e-7;
  Surface corner;
  corner.points = {{-1, -1, 0}, {side, -1, 0}, {side, 1, 0},
                   {-1, 1, 0},  {side, -1, 1}, {side, 1, 1}};
  corner.triangles = {{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}};
  for (const BodyKind kind : {BodyKind::rigid, BodyKind::fem}) {
    Body body = cube("upper", kind, height, 0);
    body.material.poissons_ratio = 0;
    Scene scene = bonding_scene({body}, 5e-3, 1e-6);
    scene.contact.pairs[0].friction = 0;
    scene.obstacles[0].geometry = corner;
    Simulator simulator(scene);
    while (simulator.time() < 0.2 - scene.time_step / 2) simulator.step();
    double wall = 0, floor = 0;
    for (const ContactPoint& contact : simulator.contacts()) {
      const double bonded = contact.intensity * contact.area;
      (std::abs(contact.normal[2]) > 0.5 ? floor : wall) += bonded;
    }
    EXPECT_LT(wall, 0.01 * floor) << static_cast<int>(kind);
    EXPECT_NEAR(floor / bonded_by(cube_weight), 1, 0.05) << static_cast<int>(kind);
  }
}

}  // namespace
}  // namespace tetwarp::test

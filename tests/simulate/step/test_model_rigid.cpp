#include <gtest/gtest.h>

#include <cmath>

#include "host/simulate/model/rotations.hpp"
#include "tests/simulate/simulate_scenes.hpp"

namespace tetwarp::test {
namespace {

using Inertia = std::array<double, 9>;  // row major

/// Inertia about the center, axes of the geometry.
Inertia inertia_of(const Model& model) {
  const RotationMatrix r = rotation_of(model.rigid.axes[0]);
  Inertia inertia{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t k = 0; k < 3; ++k) {
        inertia[3 * i + j] += r[3 * i + k] * model.rigid.inertia[0][k] * r[3 * j + k];
      }
    }
  }
  return inertia;
}

/// m/3 (b^2 + c^2) and so on, wherever the box is in its frame.
TEST(RigidMass, OfABoxIsItsClosedForm) {
  Body body = rigid_box("box", {0.2, 0.1, 0.3}, {0, 0, 0});
  const Scene scene = scene_of({body}, 0.01);
  SceneGeometry geometry = make_scene_geometry(scene);
  for (Point3& x : geometry.bodies[0].surface.points) x = plus(x, {5, -7, 2});

  const Model model = make_model(scene, geometry);

  const double mass = 1000 * 8 * 0.2 * 0.1 * 0.3;
  EXPECT_NEAR(model.rigid.mass[0], mass, 1e-11 * mass);
  EXPECT_LT(distance_of(model.rigid.center[0], {5, -7, 2}), 1e-13);
  const Inertia inertia = inertia_of(model);
  EXPECT_NEAR(inertia[0], mass / 3 * (0.01 + 0.09), 1e-12 * mass);
  EXPECT_NEAR(inertia[4], mass / 3 * (0.04 + 0.09), 1e-12 * mass);
  EXPECT_NEAR(inertia[8], mass / 3 * (0.04 + 0.01), 1e-12 * mass);
  EXPECT_NEAR(inertia[1], 0, 1e-12 * mass);
  EXPECT_NEAR(inertia[5], 0, 1e-12 * mass);
}

/// A tetrahedron with corners 0, e_x, e_y, e_z: volume 1/6, center 1/4, moments V (3/80) and V/160.
TEST(RigidMass, OfATetrahedronIsItsClosedForm) {
  Body body;
  body.name = "tetrahedron";
  body.kind = BodyKind::rigid;
  body.geometry = Surface{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                          {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  body.rigid.density = 6;

  const Model model = model_of(scene_of({body}, 0.01));

  EXPECT_NEAR(model.rigid.mass[0], 1, 1e-14);
  EXPECT_LT(distance_of(model.rigid.center[0], {0.25, 0.25, 0.25}), 1e-14);
  const Inertia inertia = inertia_of(model);
  for (std::size_t i = 0; i < 9; ++i) {
    EXPECT_NEAR(inertia[i], i % 4 == 0 ? 3.0 / 40 : 1.0 / 80, 1e-14);
  }
}

TEST(RigidMass, GivenMassAndInertiaReplaceThoseOfTheSurface) {
  Body body = rigid_box("box", {1, 1, 1}, {0, 0, 0});
  body.rigid.mass = 3;
  body.rigid.inertia = {2, 3, 4, 0.1, -0.2, 0.3};

  const Model model = model_of(scene_of({body}, 0.01));

  EXPECT_EQ(model.rigid.mass[0], 3);
  const Inertia inertia = inertia_of(model);
  const Inertia expected{2, 0.1, 0.3, 0.1, 3, -0.2, 0.3, -0.2, 4};
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(inertia[i], expected[i], 1e-14);
}

/// The start state turns with the pose: L = R I R^T omega.
TEST(RigidStart, FollowsPoseAndSpin) {
  Body body = rigid_box("box", {0.2, 0.1, 0.3}, {1, 2, 3});
  body.pose.rotation = quaternion_of(Point3{0.3, -0.5, 0.7});
  body.angular_velocity = {1, 2, -1};
  body.velocity = {4, 5, 6};

  const Model model = model_of(scene_of({body}, 0.01));

  const Inertia inertia = inertia_of(model);
  const Point3 turned = rotate(conjugate(body.pose.rotation), body.angular_velocity);
  const Point3 expected = rotate(body.pose.rotation, times(inertia, turned));
  EXPECT_LT(distance_of(model.start.angular_momentum[0], expected), 1e-12);
  EXPECT_EQ(model.start.position[0], (Point3{1, 2, 3}));
  EXPECT_EQ(model.start.velocity[0], (Point3{4, 5, 6}));
  EXPECT_EQ(model.start.velocity[1], (Point3{1, 2, -1}));
}

TEST(Rotations, AxisAngleInvertsQuaternion) {
  for (const Point3& turn : {Point3{0, 0, 0}, Point3{1e-10, 0, 0}, Point3{0.3, -0.4, 0.5},
                             Point3{3.1, 0, 0}, Point3{0, -1, 2}}) {
    EXPECT_LT(distance_of(axis_angle_of(quaternion_of(turn)), turn), 1e-14);
  }
}

}  // namespace
}  // namespace tetwarp::test

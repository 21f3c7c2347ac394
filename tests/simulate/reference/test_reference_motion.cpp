/// Energies and momenta of bodies that move freely, on the reference.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "tests/support/body_scenes.hpp"
#include "tests/support/eigen_points.hpp"

namespace tetwarp::test {
namespace {

using Eigen::Vector3d;

struct EnergyRun {
  double start = 0, end = 0, largest_gain = 0;
};

/// A cube of 0.2 m stretched by a tenth along x, spinning at 2 rad/s, for 100 steps.
EnergyRun vibrate(double youngs_modulus, double time_step) {
  Scene scene = scene_of(time_step, 100);
  scene.bodies = {elastic_box("cube", {0.1, 0.1, 0.1}, {2, 2, 2}, {youngs_modulus, 0.3, 1000})};
  const SceneBodies cube(scene);
  auto bodies = cube.bodies();
  std::vector<Point3> positions = cube.geometry.bodies[0].nodes, velocities;
  for (Point3& x : positions) {
    x[0] *= 1.1;
    velocities.push_back({-2 * x[1], 2 * x[0], 0});
  }
  set_nodes(bodies, positions, velocities);

  EnergyRun run;
  double before = run.start = bodies.record().energy.total();
  for (int step = 0; step < 100; ++step) {
    bodies.step();
    run.end = bodies.record().energy.total();
    run.largest_gain = std::max(run.largest_gain, run.end - before);
    before = run.end;
  }
  return run;
}

TEST(ReferenceMotion, OfAFreeElasticBodyLosesEnergy) {
  for (const double youngs_modulus : {1e4, 1e6, 1e8}) {
    for (const double time_step : {1e-4, 1e-3, 5e-3, 2e-2}) {
      const EnergyRun run = vibrate(youngs_modulus, time_step);

      EXPECT_LE(run.end, run.start) << youngs_modulus << ' ' << time_step;
      EXPECT_LT(run.largest_gain, 1e-4 * run.start) << youngs_modulus << ' ' << time_step;
    }
  }
}

struct TopRun {
  double momentum_change = 0, energy_change = 0;  ///< largest, relative
};

/// A rigid body with moments 1, 2, 3, spinning near the axis of the middle one for 20 s.
TopRun spin(double time_step) {
  const auto steps = static_cast<int>(std::lround(20 / time_step));
  Scene scene = scene_of(time_step, steps);
  Body top = rigid_box("top", {0.5, 0.5, 0.5}, 1000);
  top.rigid.mass = 1;
  top.rigid.inertia = {1, 2, 3, 0, 0, 0};
  top.angular_velocity = {0.05, 5, 0.05};
  scene.bodies = {top};
  const SceneBodies scene_bodies(scene);
  auto bodies = scene_bodies.bodies();
  const Vector3d momentum = vector_of(bodies.record().angular_momentum);
  const double energy = bodies.record().energy.kinetic;

  TopRun run;
  for (int step = 0; step < steps; ++step) {
    bodies.step();
    const StepRecord record = bodies.record();
    const Vector3d change = vector_of(record.angular_momentum) - momentum;
    run.momentum_change = std::max(run.momentum_change, change.norm() / momentum.norm());
    run.energy_change =
        std::max(run.energy_change, std::abs(record.energy.kinetic - energy) / energy);
  }
  return run;
}

TEST(ReferenceMotion, OfAFreeTopKeepsMomentumAndEnergyToSecondOrder) {
  const TopRun coarse = spin(8e-3), fine = spin(4e-3);

  EXPECT_LT(coarse.momentum_change, 1e-12);
  EXPECT_LT(fine.momentum_change, 1e-12);
  EXPECT_LT(coarse.energy_change, 1e-4);
  EXPECT_GT(coarse.energy_change, 1e-6);
  EXPECT_NEAR(coarse.energy_change / fine.energy_change, 4, 0.4);
}

/// An elastic, a rigid body and cloth, each with a velocity of its own, coupled to one another.
Scene coupled_scene() {
  Scene scene = scene_of(5e-3, 1);
  Body block = elastic_box("block", {0.1, 0.1, 0.1}, {1, 1, 2}, {1e5, 0.3, 1000});
  block.damping.gamma = 2e-3;
  block.angular_velocity = {1, 2, -1};
  Body brick = rigid_box("brick", {0.1, 0.05, 0.05}, 500);
  brick.pose.position = {0.3, 0, 0};
  brick.velocity = {0, 0.5, 1};
  brick.angular_velocity = {-1, 0, 3};
  Body flag = sheet_body("flag", {0.2, 0.2}, {2, 2}, {0.3, 400, 80, 2e-4});
  flag.pose.position = {0.4, 0.1, 0};
  flag.velocity = {0.3, 0, 0};
  scene.bodies = {block, brick, flag};
  Coupling first;
  first.a = "block";
  first.b = "brick";
  first.select_a = {HalfSpaceSelection{{1, 0, 0}, 0.099}};
  first.stiffness = 1e3;
  first.damping = 1;
  Coupling second;
  second.a = "flag";
  second.b = "brick";
  second.select_a = {NodeSelection{{0, 1}}};
  second.stiffness = 200;
  scene.couplings = {first, second};
  return scene;
}

TEST(ReferenceMotion, OfCoupledBodiesKeepsTheirMomentum) {
  const SceneBodies scene(coupled_scene());
  auto bodies = scene.bodies();
  const Vector3d before = vector_of(bodies.record().momentum);

  for (int step = 0; step < 50; ++step) bodies.step();

  EXPECT_LT((vector_of(bodies.record().momentum) - before).norm(), 1e-12 * before.norm());
}

/// m (v' - v)/dt of every body is its weight plus the forces that its record names.
TEST(ReferenceMotion, OfABodyFollowsFromTheForcesOfItsRecord) {
  Scene from = coupled_scene();
  from.gravity = {0, 0, -9.81};
  from.bodies[0].fixed = {HalfSpaceSelection{{-1, 0, 0}, 0.099}};
  Handle handle;
  handle.body = "flag";
  handle.select = {NodeSelection{{8}}};
  handle.stiffness = 50;
  handle.damping = 2;
  handle.path = {{0, Point3{0, 0, 0}}, {1, Point3{0.1, 0.2, 0.3}}};
  from.handles = {handle};
  Load load;
  load.body = "brick";
  load.select = {AllSelection{}};
  load.force = Point3{1, 2, 3};
  from.loads = {load};
  const SceneBodies scene(from);
  auto bodies = scene.bodies();

  for (int step = 0; step < 10; ++step) {
    const StepRecord before = bodies.record();
    bodies.step();
    const StepRecord after = bodies.record();
    for (std::size_t b = 0; b < 3; ++b) {
      const BodyRecord& of = after.bodies[b];
      double mass = 0;
      for (const double m : bodies.masses(b)) mass += m;
      const Vector3d force = mass * vector_of(from.gravity) + vector_of(of.support_force) +
                             vector_of(of.handle_force) + vector_of(of.coupling_force) +
                             vector_of(of.load_force);
      const Vector3d change = vector_of(of.velocity) - vector_of(before.bodies[b].velocity);
      EXPECT_LT((mass / from.time_step * change - force).norm(), 1e-9 * force.norm()) << b;
    }
  }
}

}  // namespace
}  // namespace tetwarp::test

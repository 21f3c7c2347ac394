/// Closed forms of elastic bodies at rest and in given positions, on the reference.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "host/reference/simulate/forces.hpp"
#include "host/reference/simulate/make_system.hpp"
#include "host/reference/simulate/step_system.hpp"
#include "tests/support/body_scenes.hpp"
#include "tests/support/eigen_points.hpp"

namespace tetwarp::test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Point3 point_of(const Vector3d& v) {
  return {v(0), v(1), v(2)};
}

bool is_outside(const Point3& x, double half) {
  return std::abs(x[0]) > half || std::abs(x[1]) > half || std::abs(x[2]) > half;
}

std::vector<Point3> mapped(const std::vector<Point3>& points,
                           const Matrix3d& linear,
                           const Vector3d& offset) {
  std::vector<Point3> result;
  result.reserve(points.size());
  for (const Point3& x : points) result.push_back(point_of(linear * vector_of(x) + offset));
  return result;
}

Matrix3d turn(double angle) {
  return Eigen::AngleAxisd(angle, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
}

/// Nodes within the unit cube off their lattice places by up to 0.15 of an edge.
void jitter(BodyGeometry& geometry, double edge) {
  Noise noise(7);
  for (Point3& x : geometry.nodes) {
    const Point3 shift = noise.point(0.15 * edge);
    if (is_outside(x, 0.499)) continue;
    for (std::size_t d = 0; d < 3; ++d) x[d] += shift[d];
  }
}

Scene cube_scene(std::int64_t cells, double poissons_ratio, double time_step) {
  Scene scene = scene_of(time_step, 1);
  scene.bodies = {
      elastic_box("cube", {0.5, 0.5, 0.5}, {cells, cells, cells}, {1e5, poissons_ratio, 1000})};
  return scene;
}

/// Boundary nodes held on an affine map; the others find it from where they were at rest. A step of
/// 1000 s leaves out inertia, so each is one step of Newton's method with fixed rotations.
double patch_error(const Matrix3d& linear, int steps) {
  SceneBodies cube(cube_scene(4, 0.3, 1e3));
  BodyGeometry& geometry = cube.geometry.bodies[0];
  jitter(geometry, 0.25);
  geometry.fixed = nodes_where(geometry, [](const Point3& x) { return is_outside(x, 0.499); });
  const std::vector<Point3> exact = mapped(geometry.nodes, linear, {0.1, 0.2, 0.3});
  std::vector<Point3> start = exact;
  for (std::size_t n = 0; n < start.size(); ++n) {
    if (!is_outside(geometry.nodes[n], 0.499)) start[n] = geometry.nodes[n];
  }
  auto bodies = cube.bodies();
  set_nodes(bodies, start, std::vector<Point3>(start.size()));

  for (int step = 0; step < steps; ++step) bodies.step();

  return largest_distance(bodies.node_positions(0), exact);
}

TEST(ReferenceElements, HoldAnAffineMapOfSmallStrain) {
  Matrix3d linear = Matrix3d::Identity();
  linear(0, 1) = 1e-4;
  linear(2, 2) = 1 + 2e-4;

  EXPECT_LT(patch_error(linear, 8), 1e-14);
}

TEST(ReferenceElements, HoldAnAffineMapOfLargeStrainAndRotation) {
  Matrix3d strain = Matrix3d::Identity();
  strain(0, 0) = 1.2;
  strain(1, 1) = 0.9;
  strain(0, 1) = strain(1, 0) = 0.1;

  EXPECT_LT(patch_error(turn(1) * strain, 24), 1e-12);
}

/// Forces of the elements on the nodes at given positions [N].
std::vector<Vector3d> elastic_forces(const SceneBodies& cube,
                                     const std::vector<Point3>& positions) {
  const reference::System system = reference::make_system(cube.scene, cube.geometry);
  reference::State state = reference::start_of(system);
  for (std::size_t n = 0; n < positions.size(); ++n) state.node[n] = vector_of(positions[n]);
  const Eigen::VectorXd force = reference::elastic_force(system, state);
  std::vector<Vector3d> forces;
  for (std::size_t n = 0; n < positions.size(); ++n) {
    forces.push_back(force.segment<3>(3 * static_cast<Eigen::Index>(n)));
  }
  return forces;
}

TEST(ReferenceElements, FeelNoForceAfterARigidMotionFarFromTheOrigin) {
  SceneBodies cube(cube_scene(2, 0.3, 1e-3));
  jitter(cube.geometry.bodies[0], 0.5);
  const auto& nodes = cube.geometry.bodies[0].nodes;

  const auto forces = elastic_forces(cube, mapped(nodes, turn(2.5), {1e3, 2e3, 3e3}));

  const double scale = 1e5 * 0.25;  // E h^2
  for (const Vector3d& force : forces) EXPECT_LT(force.norm(), 1e-10 * scale);
}

/// Rest positions moved by up to 0.1, a fifth of an edge.
std::vector<Point3> strained(const std::vector<Point3>& nodes, std::uint64_t seed) {
  Noise noise(seed);
  std::vector<Point3> result = mapped(nodes, turn(0.7), {0, 0, 0});
  for (Point3& x : result) {
    const Point3 shift = noise.point(0.1);
    for (std::size_t d = 0; d < 3; ++d) x[d] += shift[d];
  }
  return result;
}

TEST(ReferenceElements, OfAStrainedBlockExertNeitherNetForceNorTorque) {
  const SceneBodies cube(cube_scene(2, 0.3, 1e-3));
  const auto positions = strained(cube.geometry.bodies[0].nodes, 3);

  const auto forces = elastic_forces(cube, positions);

  Vector3d sum = Vector3d::Zero(), torque = Vector3d::Zero();
  double largest = 0;
  for (std::size_t n = 0; n < forces.size(); ++n) {
    sum += forces[n];
    torque += vector_of(positions[n]).cross(forces[n]);
    largest = std::max(largest, forces[n].norm());
  }
  EXPECT_GT(largest, 100);
  EXPECT_LT(sum.norm(), 1e-13 * largest);
  EXPECT_LT(torque.norm(), 1e-13 * largest);
}

/// |force . d + difference quotient of the energy along d| over the size of the quotient.
double gradient_error(double step) {
  SceneBodies cube(cube_scene(2, 0.3, 1e-3));
  auto bodies = cube.bodies();
  const auto positions = strained(cube.geometry.bodies[0].nodes, 5);
  Noise noise(11);
  std::vector<Point3> direction;
  for (std::size_t n = 0; n < positions.size(); ++n) direction.push_back(noise.point(1));
  const auto energy_at = [&](double t) {
    auto moved = positions;
    for (std::size_t n = 0; n < moved.size(); ++n) {
      for (std::size_t d = 0; d < 3; ++d) moved[n][d] += t * direction[n][d];
    }
    set_nodes(bodies, moved, std::vector<Point3>(moved.size()));
    return bodies.record().energy.elastic;
  };
  const double slope = (energy_at(step) - energy_at(-step)) / (2 * step);
  const auto forces = elastic_forces(cube, positions);
  double power = 0;
  for (std::size_t n = 0; n < forces.size(); ++n) power += forces[n].dot(vector_of(direction[n]));
  return std::abs(power + slope) / std::abs(slope);
}

TEST(ReferenceElements, ExertTheGradientOfTheirEnergy) {
  const double coarse = gradient_error(1e-3), fine = gradient_error(1e-4);

  EXPECT_LT(fine, 1e-5);
  EXPECT_NEAR(coarse / fine, 100, 20);  // of second order
}

}  // namespace
}  // namespace tetwarp::test

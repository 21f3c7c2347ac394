/// Tangled elastic bodies that find back to their shape, and the order of bodies and nodes, on the
/// reference.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tests/support/body_scenes.hpp"

namespace tetwarp::test {
namespace {

/// Energy left over the size of one stretched to twice its length, after 400 damped steps of 10 ms.
struct Recovery {
  std::int64_t inverted_at_start = 0, inverted = 0;
  double energy = 0;
};

template <class Tangle>
Recovery recover(Body body, const Tangle& tangle) {
  Scene scene = scene_of(1e-2, 400);
  body.damping = {2, 2e-3};
  scene.bodies = {body};
  const SceneBodies block(scene);
  auto bodies = block.bodies();
  std::vector<Point3> positions = block.geometry.bodies[0].nodes;
  tangle(positions);
  set_nodes(bodies, positions, std::vector<Point3>(positions.size()));
  Recovery recovery;
  recovery.inverted_at_start = bodies.record().inverted;

  for (int step = 0; step < 400; ++step) bodies.step();

  recovery.inverted = bodies.record().inverted;
  recovery.energy = bodies.record().energy.elastic;
  return recovery;
}

Body cube_of(std::int64_t cells) {
  return elastic_box("cube", {0.15, 0.15, 0.15}, {cells, cells, cells}, {1e4, 0.3, 1000});
}

TEST(ReferenceRecovery, OfOneTetrahedronSucceedsFromAnyNodes) {
  Body tet = cube_of(1);
  Mesh mesh;
  mesh.rest_positions = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1}};
  mesh.tets = {{0, 1, 2, 3}};
  tet.geometry = mesh;
  tet.lattice.reset();
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const Recovery recovery = recover(tet, [&](std::vector<Point3>& positions) {
      Noise noise(seed);
      for (Point3& x : positions) x = noise.point(0.1);
    });

    EXPECT_EQ(recovery.inverted, 0) << seed;
    EXPECT_LT(recovery.energy, 1e-9) << seed;
  }
}

/// Blocks of 2^3 and 3^3 cells.
class ReferenceRecoveryOf : public testing::TestWithParam<std::int64_t> {};
INSTANTIATE_TEST_SUITE_P(Cells, ReferenceRecoveryOf, testing::Values(2, 3));

TEST_P(ReferenceRecoveryOf, ABlockSucceedsFromNoiseOfAnEdge) {
  const double edge = 0.3 / static_cast<double>(GetParam());
  for (std::uint64_t seed = 0; seed < 2; ++seed) {
    const Recovery recovery = recover(cube_of(GetParam()), [&](std::vector<Point3>& positions) {
      Noise noise(seed);
      for (Point3& x : positions) {
        const Point3 shift = noise.point(edge);
        for (std::size_t d = 0; d < 3; ++d) x[d] += shift[d];
      }
    });

    EXPECT_GT(recovery.inverted_at_start, 5);
    EXPECT_EQ(recovery.inverted, 0);
    EXPECT_LT(recovery.energy, 1e-6);
  }
}

TEST_P(ReferenceRecoveryOf, AFlattenedBlockSucceeds) {
  const Recovery recovery = recover(cube_of(GetParam()), [](std::vector<Point3>& positions) {
    Noise noise(1);
    for (Point3& x : positions) x[2] = 1e-9 * noise();
  });

  EXPECT_EQ(recovery.inverted, 0);
  EXPECT_LT(recovery.energy, 1e-6);
}

TEST_P(ReferenceRecoveryOf, ABlockInOnePointComesAlmostBack) {
  const Recovery recovery = recover(cube_of(GetParam()), [](std::vector<Point3>& positions) {
    Noise noise(2);
    for (Point3& x : positions) x = noise.point(1e-9);
  });

  EXPECT_EQ(recovery.inverted, 0);
  EXPECT_LT(recovery.energy, 1e-3);
}

/// Two elastic bodies and a brick, coupled. `order` are the places of the bodies, `nodes` the new
/// places of the nodes of the first.
Scene shuffled_scene(const std::vector<std::size_t>& order,
                     const std::vector<std::int32_t>& nodes) {
  Mesh mesh;
  mesh.rest_positions.resize(5);
  const std::vector<Point3> positions{
      {0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1}, {0.1, 0.1, 0.1}};
  for (std::size_t n = 0; n < 5; ++n) {
    mesh.rest_positions[static_cast<std::size_t>(nodes[n])] = positions[n];
  }
  mesh.tets = {{nodes[0], nodes[1], nodes[2], nodes[3]}, {nodes[1], nodes[2], nodes[3], nodes[4]}};
  Body kite = cube_of(1);
  kite.name = "kite";
  kite.geometry = mesh;
  kite.lattice.reset();
  Body cube = cube_of(1);
  cube.pose.position = {0.4, 0, 0};
  Body brick = rigid_box("brick", {0.05, 0.05, 0.05}, 700);
  brick.pose.position = {0.2, 0.3, 0};
  const std::vector<Body> bodies{kite, cube, brick};
  Scene scene = scene_of(5e-3, 20, {0, 0, -9.81});
  for (const std::size_t b : order) scene.bodies.push_back(bodies[b]);
  Coupling spring;
  spring.a = "kite";
  spring.b = "cube";
  spring.select_a = {AllSelection{}};
  spring.stiffness = 300;
  Coupling second = spring;
  second.a = "cube";
  second.b = "brick";
  scene.couplings = {spring, second};
  return scene;
}

TEST(ReferenceOrder, OfBodiesAndNodesDoesNotMatter) {
  const SceneBodies first(shuffled_scene({0, 1, 2}, {0, 1, 2, 3, 4}));
  const std::vector<std::int32_t> places{3, 0, 4, 2, 1};
  const SceneBodies second(shuffled_scene({2, 0, 1}, places));
  auto a = first.bodies(), b = second.bodies();

  for (int step = 0; step < 20; ++step) {
    a.step();
    b.step();
  }

  std::vector<Point3> kite;
  kite.reserve(places.size());
  for (const std::int32_t n : places) {
    kite.push_back(b.node_positions(1)[static_cast<std::size_t>(n)]);
  }
  EXPECT_LT(largest_distance(a.node_positions(0), kite), 1e-12);
  EXPECT_LT(largest_distance(a.node_positions(1), b.node_positions(2)), 1e-12);
  EXPECT_LT(largest_distance({a.record().bodies[2].center}, {b.record().bodies[0].center}), 1e-12);
}

}  // namespace
}  // namespace tetwarp::test

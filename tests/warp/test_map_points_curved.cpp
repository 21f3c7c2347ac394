/// @file test_map_points_curved.cpp
/// Points that meshes of ten-node tetrahedra take along.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include <tetwarp/map_points.hpp>

#include "host/base/point3.hpp"
#include "tests/support/curved_scenes.hpp"
#include "tests/support/each_backend.hpp"

namespace tetwarp::test {
namespace {
class MapPointsCurved : public EachBackend {};
INSTANTIATE_TEST_SUITE_P(Backends, MapPointsCurved, each_backend, name_of_backend);

CurvedMesh small_cubes() {
  return with_mid_nodes(scenes::lattice({3, 3, 3}, {0, 0, 0}, {12, 12, 12}));
}

/// Within the cube of small_cubes(), and a little around it.
std::vector<Point3> scattered(std::size_t count) {
  std::vector<Point3> points(count);
  for (std::size_t p = 0; p < count; ++p) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      points[p][axis] = 13 * scenes::uniform(9, 3 * p + axis) - 0.5;
    }
  }
  return points;
}

TEST_P(MapPointsCurved, FollowAQuadraticMotionAndReturn) {
  const CurvedMesh mesh = small_cubes();
  std::vector<Point3> deformed;
  for (const Point3& x : mesh.mesh.rest_positions) deformed.push_back(quadratic(x));
  const std::vector<Point3> points = scattered(300);

  const MappedPoints there = map_points(mesh, deformed, points, {.backend = GetParam()});
  const MappedPoints back =
      map_points(mesh, deformed, there.points, {.inverse = true, .backend = GetParam()});

  std::size_t returned = 0;
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (there.owners[p] < 0) {
      EXPECT_EQ(there.points[p], points[p]);
      continue;
    }
    EXPECT_LT(norm(minus(there.points[p], quadratic(points[p]))), 1e-12) << p;
    if (back.owners[p] < 0) continue;  // between the straight and the curved hull
    EXPECT_LT(norm(minus(back.points[p], points[p])), 1e-8) << p;
    ++returned;
  }
  EXPECT_EQ(there.straightened, 0);
  EXPECT_EQ(back.straightened, 0);
  EXPECT_GT(returned, 150U);
}

TEST_P(MapPointsCurved, HaveTheBitsOfFourNodesWhereEdgesAreStraight) {
  const CurvedMesh mesh = small_cubes();
  const std::vector<Point3> deformed = straightened(mesh, shaken(mesh.mesh.rest_positions, 0.8, 2));
  for (const bool inverse : {false, true}) {
    const MapPointsOptions options = {.inverse = inverse, .backend = GetParam()};
    const MappedPoints ten = map_points(mesh, deformed, scattered(300), options);
    const MappedPoints four = map_points(mesh.mesh, deformed, scattered(300), options);

    EXPECT_EQ(ten.points, four.points);
    EXPECT_EQ(ten.owners, four.owners);
    EXPECT_EQ(ten.straightened, 0);
  }
}

/// One middle node goes 2^42 voxels away, and takes all points of its cells along.
TEST_P(MapPointsCurved, FollowAMiddleNodeBeyondTheLimits) {
  const CurvedMesh mesh = small_cubes();
  std::vector<Point3> deformed = mesh.mesh.rest_positions;
  const auto far = static_cast<std::size_t>(mesh.mid_nodes[0][0]);
  deformed[far][0] += 0x1p42;
  const Grid grid = scenes::unit_grid(13, 13, 13);

  const Point3 corner = mesh.mesh.rest_positions[static_cast<std::size_t>(mesh.mesh.tets[0][0])];
  const MappedPoints moved = map_points(mesh, deformed, {corner, mesh.mesh.rest_positions[far]},
                                        {.grid = grid, .backend = GetParam()});

  EXPECT_EQ(moved.points[0], corner);
  EXPECT_NEAR(moved.points[1][0] / deformed[far][0], 1, 1e-9);
  EXPECT_EQ(moved.straightened, 0);
}

/// Gently and wildly bent edges: of folded cells some points have no place.
TEST_P(MapPointsCurved, AreTheReference) {
  if (GetParam() == Backend::reference) GTEST_SKIP() << "the reference is not compared with itself";
  CurvedMesh mesh = small_cubes();
  mesh.mesh.rest_positions = shaken(mesh.mesh.rest_positions, 0.3, 4);
  mesh.mid_nodes[5] = no_mid_nodes;
  for (const bool inverse : {false, true}) {
    const std::vector<Point3> deformed = shaken(mesh.mesh.rest_positions, 0.4, 5);
    const auto run = [&](Backend backend) {
      return map_points(mesh, deformed, scattered(300), {.inverse = inverse, .backend = backend});
    };
    const MappedPoints here = run(GetParam()), judge = run(Backend::reference);
    EXPECT_EQ(here.owners, judge.owners);
    EXPECT_EQ(here.straightened, judge.straightened);
    for (std::size_t p = 0; p < here.points.size(); ++p) {
      EXPECT_LT(norm(minus(here.points[p], judge.points[p])), 1e-7) << p;
    }
  }
  std::vector<Point3> folded = shaken(mesh.mesh.rest_positions, 4, 6);
  for (std::size_t n = 0; n < 4 * 4 * 4; ++n) folded[n] = mesh.mesh.rest_positions[n];
  const MappedPoints lost =
      map_points(mesh, folded, scattered(300), {.inverse = true, .backend = GetParam()});
  EXPECT_GT(lost.straightened, 10);
  EXPECT_LT(lost.straightened, 290);
}
}  // namespace
}  // namespace tetwarp::test

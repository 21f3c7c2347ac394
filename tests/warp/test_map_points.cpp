/// @file test_map_points.cpp
/// Points that meshes take along: owners as in a warp, laws of motion, equality of the back ends.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <tetwarp/map_points.hpp>

#include "host/base/point3.hpp"
#include "tests/support/each_backend.hpp"
#include "tests/support/each_scene.hpp"
#include "tests/support/hex_scenes.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/warp_run.hpp"

namespace tetwarp::test {
namespace {
class MapPoints : public EachBackend {};
INSTANTIATE_TEST_SUITE_P(Backends, MapPoints, each_backend, name_of_backend);

class MapPointsScene : public EachScene<14> {};
INSTANTIATE_TEST_SUITE_P(Scenes,
                         MapPointsScene,
                         ::testing::ValuesIn(all_scene_names()),
                         scene_name);

std::vector<Point3> centers_of(const Grid& grid) {
  std::vector<Point3> centers;
  for (std::int64_t k = 0; k < grid.dims[2]; ++k) {
    for (std::int64_t j = 0; j < grid.dims[1]; ++j) {
      for (std::int64_t i = 0; i < grid.dims[0]; ++i) {
        centers.push_back(grid.world_of(
            {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}));
      }
    }
  }
  return centers;
}

/// Anywhere in a box a little larger than that of the nodes.
std::vector<Point3> scattered(const std::vector<Point3>& nodes, std::uint64_t count) {
  const Bounds box = bounds_of(nodes);
  std::vector<Point3> points(count);
  for (std::uint64_t p = 0; p < count; ++p) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double u = 1.1 * scenes::uniform(5, 3 * p + axis) - 0.05;
      points[p][axis] = box.low[axis] + u * (box.high[axis] - box.low[axis]);
    }
  }
  return points;
}

Mesh cubes() {
  return scenes::lattice({3, 4, 2}, {-1, 0, 2}, {5, 8, 6});
}

TEST_P(MapPointsScene, VoxelCentersHaveTheOwnersOfTheWarp) {
  const scenes::Scene& scene = this->scene();
  const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::uint8);
  const Warped warped = run_warp(source, scene, Backend::cpu);
  MapPointsOptions options{.inverse = true, .grid = scene.output_grid};

  const auto centers = centers_of(scene.output_grid);
  const MappedPoints mapped = map_points(scene.mesh, scene.deformed, centers, options);

  EXPECT_TRUE(mapped.owners == warped.owner);
  EXPECT_EQ(mapped.outside, std::count(warped.owner.begin(), warped.owner.end(), -1));
}

TEST_P(MapPointsScene, BackEndsGiveEqualOwnersAndPlaces) {
  const scenes::Scene& scene = this->scene();
  const std::vector<Point3> points = scattered(scene.deformed, 500);
  const auto run = [&](Backend backend) {
    return map_points(scene.mesh, scene.deformed, points, {.inverse = true, .backend = backend});
  };
  const MappedPoints truth = run(Backend::reference);
  const Bounds box = bounds_of(scene.mesh.rest_positions);
  const double size = norm(minus(box.high, box.low));

  for (const BackendStatus& status : available_backends()) {
    if (!status.usable) continue;
    const MappedPoints mapped = run(status.backend);

    EXPECT_TRUE(mapped.owners == truth.owners);
    EXPECT_EQ(mapped.outside, truth.outside);
    // The reference weighs by rounded nodes, which thin cells magnify.
    if (scene.name.starts_with("slivers") || scene.name.starts_with("thin")) continue;
    for (std::size_t p = 0; p < points.size(); ++p) {
      EXPECT_LT(norm(minus(mapped.points[p], truth.points[p])), 1e-8 * size) << p;
    }
  }
}

TEST_P(MapPoints, FollowAnAffineMotion) {
  const Mesh mesh = cubes();
  const auto affine = [](const Point3& x) {
    return Point3{2 + 1.5 * x[0] - 0.25 * x[1], 0.5 * x[1] + 0.125 * x[2] - 7, x[2] + 0.75 * x[0]};
  };
  std::vector<Point3> deformed;
  for (const Point3& x : mesh.rest_positions) deformed.push_back(affine(x));
  const std::vector<Point3> points = scattered(mesh.rest_positions, 200);

  const MappedPoints mapped = map_points(mesh, deformed, points, {.backend = GetParam()});
  const MappedPoints back =
      map_points(mesh, deformed, mapped.points, {.inverse = true, .backend = GetParam()});

  const double bound = GetParam() == Backend::reference ? 1e-9 : 1e-13;  // of rounded nodes
  int inside = 0;
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (mapped.owners[p] < 0) continue;
    ++inside;
    EXPECT_LT(norm(minus(mapped.points[p], affine(points[p]))), bound);
    if (back.owners[p] < 0) continue;
    EXPECT_LT(norm(minus(back.points[p], points[p])), 4 * bound);
  }
  EXPECT_GT(inside, 100);
  EXPECT_LE(back.outside, mapped.outside + 2);
}

TEST_P(MapPoints, StayWhereNodesStayAndWhereNoCellIs) {
  const Mesh mesh = cubes();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Point3> points = scattered(mesh.rest_positions, 100);
  points.push_back({1e300, 0, 3});
  points.push_back({9, 1, 3});

  const MappedPoints mapped =
      map_points(mesh, mesh.rest_positions, points, {.backend = GetParam()});
  EXPECT_TRUE(mapped.points == points);
  EXPECT_EQ(mapped.owners.back(), -1);
  EXPECT_EQ(mapped.outside, std::count(mapped.owners.begin(), mapped.owners.end(), -1));

  const MappedPoints none =
      map_points(mesh, mesh.rest_positions, {{nan, 1, 3}}, {.backend = GetParam()});
  EXPECT_EQ(none.outside, 1);
  EXPECT_TRUE(std::isnan(none.points[0][0]));
}

TEST_P(MapPoints, OfACellGoWithItsNodes) {
  const Mesh mesh{{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}}, {{0, 1, 2, 3}}};
  const std::vector<Point3> deformed{{10, 0, 0}, {10, 4, 0}, {8, 0, 0}, {10, 0, 6}};

  const MappedPoints mapped = map_points(
      mesh, deformed, {{2, 0, 0}, {0.5, 0.5, 0.5}, {0, 1, 0}, {1, 1, 1}}, {.backend = GetParam()});

  EXPECT_EQ(mapped.owners, (std::vector<std::int32_t>{0, 0, 0, -1}));
  EXPECT_EQ(mapped.points[0], (Point3{10, 4, 0}));
  EXPECT_EQ(mapped.points[1], (Point3{9.5, 1, 1.5}));
  EXPECT_EQ(mapped.points[2], (Point3{9, 0, 0}));
  EXPECT_EQ(mapped.points[3], (Point3{1, 1, 1}));
}

/// Points of a hexahedron's trilinear map, from their local coordinates.
TEST_P(MapPoints, InHexahedraFollowTheTrilinearMap) {
  const HexBox box = hex_box({2, 3, 2}, {0, 0, 0}, {9, 12, 6}, bent(0.6));
  const HexBox fine = hex_box({2, 3, 2}, {0, 0, 0}, {9, 12, 6}, bent(0.6), 3);

  const MappedPoints forward =
      map_points(box.mesh, box.deformed, fine.mesh.rest_positions, {.backend = GetParam()});
  const MappedPoints inverse =
      map_points(box.mesh, box.deformed, fine.deformed, {.inverse = true, .backend = GetParam()});

  EXPECT_EQ(forward.outside, 0);
  std::int64_t held = 0;
  for (std::size_t p = 0; p < fine.deformed.size(); ++p) {
    EXPECT_LT(norm(minus(forward.points[p], fine.deformed[p])), 1e-8);
    if (inverse.owners[p] < 0) continue;  // beyond the triangles that stand for a curved face
    ++held;
    EXPECT_LT(norm(minus(inverse.points[p], fine.mesh.rest_positions[p])), 1e-7);
  }
  EXPECT_GT(held, std::ssize(fine.deformed) / 2);
  EXPECT_LT(*std::max_element(forward.owners.begin(), forward.owners.end()), 12);
}

TEST_P(MapPoints, OfAnyNumberGiveEachTheSameBits) {
  const Mesh mesh = cubes();
  const std::vector<Point3> deformed = scenes::waved(mesh.rest_positions, 0.2, 3);
  const std::vector<Point3> all = scattered(mesh.rest_positions, 1025);
  const MappedPoints truth = map_points(mesh, deformed, all, {.backend = GetParam()});
  for (const std::size_t count : {0, 1, 31, 32, 33, 1025}) {
    for (const int threads : {1, 3}) {
      const std::vector<Point3> some(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count));
      const MappedPoints mapped =
          map_points(mesh, deformed, some, {.backend = GetParam(), .threads = threads});
      ASSERT_EQ(mapped.points.size(), count);
      for (std::size_t p = 0; p < count; ++p) {
        EXPECT_EQ(mapped.points[p], truth.points[p]);
        EXPECT_EQ(mapped.owners[p], truth.owners[p]);
      }
    }
  }
}

/// One tetrahedron around many small ones, behind them in number: cubes are made coarser.
TEST_P(MapPoints, AreFoundInAMeshOfVeryDifferentSizes) {
  Mesh mesh = scenes::lattice({6, 6, 6}, {0, 0, 0}, {0.01, 0.01, 0.01});
  const auto small = static_cast<std::int32_t>(mesh.tets.size());
  const auto first = static_cast<std::int32_t>(mesh.rest_positions.size());
  for (const Point3& x : {Point3{-10, -10, -10}, {90, -10, -10}, {-10, 90, -10}, {-10, -10, 90}}) {
    mesh.rest_positions.push_back(x);
  }
  mesh.tets.push_back({first, first + 1, first + 2, first + 3});
  const std::vector<Point3> deformed = scenes::shifted(mesh.rest_positions, {0, 0, 1});

  const MappedPoints mapped =
      map_points(mesh, deformed, {{0.005, 0.004, 0.003}, {1, 2, 3}}, {.backend = GetParam()});

  EXPECT_LT(mapped.owners[0], small);
  EXPECT_GE(mapped.owners[0], 0);
  EXPECT_EQ(mapped.owners[1], small);
  EXPECT_LT(norm(minus(mapped.points[1], {1, 2, 4})), 1e-12);
}

TEST(MapPointsArguments, AreNamedInOneLine) {
  const Mesh mesh = cubes();
  std::vector<Point3> broken = mesh.rest_positions;
  broken[7][1] = std::numeric_limits<double>::infinity();
  const auto message = [&](const std::vector<Point3>& deformed, const MapPointsOptions& options) {
    return message_of<std::invalid_argument>([&] {
      map_points(mesh, deformed, {{0, 0, 0}}, options);
    });
  };

  EXPECT_NE(message({{0, 0, 0}}, {}).find("expected 60 nodes as at rest, got 1"),
            std::string::npos);
  EXPECT_NE(message(broken, {}).find("node 7 is not finite"), std::string::npos);
  EXPECT_NE(message(mesh.rest_positions, {.grid = Grid{}}).find("grid of the points"),
            std::string::npos);
  Grid tiny{.dims = {1, 1, 1}, .spacing = {1e-7, 1e-7, 1e-7}};
  EXPECT_NE(message(mesh.rest_positions, {.grid = tiny}).find("spans over 2^20 voxels"),
            std::string::npos);
  EXPECT_NE(message(mesh.rest_positions, {.threads = -1}), "");
}

}  // namespace
}  // namespace tetwarp::test

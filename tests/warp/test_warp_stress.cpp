/// @file test_warp_stress.cpp
/// Difficult shapes: slivers, inverted, flat and folded tetrahedra keep the same laws. Numbers
/// behind "found" are the largest seen on cpu.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/warp_laws.hpp"

namespace tetwarp::test {
namespace {
class WarpStress : public WarpLaws {};
INSTANTIATE_TEST_SUITE_P(Backends, WarpStress, each_backend, name_of_backend);

enum class Thin { rest, deformed, both };
constexpr double middle = 16.25;  ///< of the layer, y

/// A box with a layer `thickness` thin, shortened and sheared so that the layer's middle runs
/// through voxel centers. All but the thickness is whole quanta.
Solid sliver_solid(double thickness, Thin thin) {
  const Grid grid = scenes::unit_grid(40, 32, 32);
  Solid solid;
  solid.low = {10.25, middle - 12, 4.25};
  solid.high = {30.25, middle + 12, 28.25};
  const auto layered = [&](double thick) {
    const double planes[4] = {solid.low[0], 20 - thick / 2, 20 + thick / 2, solid.high[0]};
    Mesh mesh = scenes::lattice({3, 3, 3}, {0, solid.low[1], solid.low[2]},
                                {3, solid.high[1], solid.high[2]});
    for (Point3& p : mesh.rest_positions) p[0] = planes[static_cast<int>(p[0])];
    return mesh;
  };
  const Mesh rest = layered(thin == Thin::deformed ? 6 : thickness);
  std::vector<Point3> deformed = layered(thin == Thin::rest ? 6 : thickness).rest_positions;
  for (Point3& p : deformed) {
    p[1] = middle + (p[1] - middle) * 7 / 8;
    p[0] += p[1] - 16;
  }
  solid.scene = {"slivers", rest, deformed, grid, grid};
  solid.undone = [](const Point3& p) {
    return Point3{p[0] - (p[1] - 16), middle + (p[1] - middle) * 8 / 7, p[2]};
  };
  return solid;
}

/// Flattened by 1e-1 to 1e-12: at rest, deformed, or both.
/// Found: evaluation 9.5e-7 for float32, 9.4e-10 for float64 (deformed slivers of 1e-5).
TEST_P(WarpStress, SliversKeepTheLawsHoweverThin) {
  for (const PixelType type : {PixelType::float32, PixelType::float64}) {
    double worst = 0;
    for (const Thin thin : {Thin::rest, Thin::deformed, Thin::both}) {
      for (int decade = 1; decade <= 12; ++decade) {
        SCOPED_TRACE("1e-" + std::to_string(decade) + ' ' + name_of(type));
        const Solid solid = sliver_solid(std::pow(10.0, -decade), thin);
        worst = std::max(worst, expect_laws(solid, type).evaluation);
      }
    }
    found(std::string("evaluation_") + name_of(type), worst);
  }
}

/// The slivers are met: 525 voxels have their center in the thin layer, down to the quantum. Below
/// it the layer is flat and the voxels go to its neighbors.
TEST_P(WarpStress, SliversOwnTheVoxelsInThemUntilTheyAreFlat) {
  for (int decade = 1; decade <= 12; ++decade) {
    const Solid solid = sliver_solid(std::pow(10.0, -decade), Thin::both);
    const Volume source = scenes::wavy_volume(solid.scene.source_grid, PixelType::uint8);

    const Warped warped = run_warp(source, solid.scene, GetParam());

    const auto is_of_layer = [](std::int32_t t) { return t >= 0 && t / 5 % 3 == 1; };
    const bool is_flat = std::pow(10.0, -decade) < 0x1p-20;
    EXPECT_EQ(std::ranges::count_if(warped.owner, is_of_layer) > 500, !is_flat) << decade;
    EXPECT_EQ(warped.counts.flat, is_flat ? 9 * 5 : 0) << decade;
    expect_owners(solid.scene, warped.owner, 11);
  }
}

/// A mirrored mesh is inverted throughout, and maps like any other. Found: evaluation 1.7e-6.
TEST_P(WarpStress, InvertedTetrahedraMapLikeOthers) {
  const Grid grid = scenes::unit_grid(40, 40, 40);
  Solid solid = turned_solid(grid, grid, {4, 5, 4});
  for (Point3& p : solid.scene.deformed) p[0] = 39 - p[0];
  solid.undone = [undone = solid.undone](const Point3& p) {
    return undone({39 - p[0], p[1], p[2]});
  };
  const Volume source = scenes::wavy_volume(grid, PixelType::uint8);

  const Warped warped = run_warp(source, solid.scene, GetParam());

  EXPECT_EQ(warped.counts.inverted, warped.counts.tetrahedra);
  expect_owners(solid.scene, warped.owner, 7);
  found("evaluation", expect_laws(solid, PixelType::float32).evaluation);
}

/// Every second layer of cells squashed to nothing: flat tetrahedra are counted, own nothing, and
/// leave no hole. The mesh stays aligned, so that its faces pass through voxel centers, all ties.
TEST_P(WarpStress, FlatTetrahedraOwnNothingAndLeaveNoHole) {
  const Grid grid = scenes::unit_grid(40, 40, 40);
  Solid solid = turned_solid(grid, grid, {6, 4, 4});
  const double cell = (solid.high[0] - solid.low[0]) / 6;
  solid.scene.deformed = scenes::lattice({6, 4, 4}, solid.low, solid.high).rest_positions;
  for (Point3& p : solid.scene.deformed) {
    const double layer = std::round((p[0] - solid.low[0]) / cell);
    p[0] = solid.low[0] + 2 * cell * std::floor((layer + 1) / 2);
  }
  solid.undone = [](const Point3& p) { return p; };
  const Volume source = scenes::wavy_volume(grid, PixelType::uint8);

  const Warped warped = run_warp(source, solid.scene, GetParam());

  EXPECT_EQ(warped.counts.flat, 3 * 4 * 4 * 5);
  for (const std::int32_t t : warped.owner) EXPECT_TRUE(t < 0 || t / 5 % 2 == 0);
  expect_owners(solid.scene, warped.owner, 7);
  found("evaluation", expect_laws(solid, PixelType::float32).evaluation);
}

/// Inner nodes moved at random by one and a half cells: many tetrahedra are inverted, and a third
/// of the voxels lie in several. The lowest tetrahedron owns them, and the hull has no hole.
TEST_P(WarpStress, FoldsLeaveNoHoleAndKeepPositions) {
  const Grid grid = scenes::unit_grid(40, 40, 40);
  Solid solid = turned_solid(grid, grid, {6, 6, 6});
  const Mesh folded = jittered_lattice({6, 6, 6}, solid.low, solid.high, 1.5, 11);
  solid.scene.deformed = scenes::rotated_45_45(folded.rest_positions, {19.5, 19.5, 19.5});
  WarpOptions options;
  options.count_folded = true;

  const Probed probed = probe(solid.scene, GetParam(), PixelType::float32, options);

  expect_position_laws(position_errors(probed, solid.scene));
  expect_owners(solid.scene, probed.owner, 7);
  EXPECT_EQ(coverage_errors(solid, probed.owner, 0x1p-19, {0, 0, 0}, grid.dims).holes, 0);
  EXPECT_GT(probed.counts.inverted, probed.counts.tetrahedra / 5);
  EXPECT_GT(probed.counts.folded, probed.counts.covered / 3);
}
}  // namespace
}  // namespace tetwarp::test

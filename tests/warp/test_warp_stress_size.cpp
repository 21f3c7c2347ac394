/// @file test_warp_stress_size.cpp
/// Difficult sizes: axes of one voxel and of 65,536 and a million, meshes of one
/// tetrahedron and of two million. Numbers behind "found" are the largest seen on cpu.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

#include "tests/support/warp_laws.hpp"

namespace tetwarp::test {
namespace {
class WarpStressSize : public WarpLaws {};
INSTANTIATE_TEST_SUITE_P(Backends, WarpStressSize, each_backend, name_of_backend);

/// A box in the source, jittered, onto a box in the output, jittered otherwise; unit grids.
Solid box_to_box(const Grid& source,
                 const std::array<Point3, 2>& rest_box,
                 const Grid& output,
                 const std::array<Point3, 2>& box,
                 const std::array<int, 3>& cells) {
  Solid solid;
  solid.low = box[0];
  solid.high = box[1];
  solid.scene = {"boxes", jittered_lattice(cells, rest_box[0], rest_box[1], 0.1, 13),
                 jittered_lattice(cells, box[0], box[1], 0.1, 17).rest_positions, source, output};
  solid.undone = [](const Point3& p) { return p; };
  return solid;
}

/// The box of a unit grid, `inset` within its outermost rims.
std::array<Point3, 2> box_of(const Grid& grid, double inset) {
  std::array<Point3, 2> box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box[0][axis] = inset - 0.5;
    box[1][axis] = static_cast<double>(grid.dims[axis]) - 0.5 - inset;
  }
  return box;
}

/// In the source such an axis is constant, in the output it is a slice. Found: evaluation 1.6e-6.
TEST_P(WarpStressSize, AxesOfOneVoxelKeepTheLaws) {
  double worst = 0;
  for (int ones = 1; ones < 8; ++ones) {
    Grid thin = scenes::unit_grid(24, 20, 22);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if ((ones >> axis & 1) != 0) thin.dims[axis] = 1;
    }
    const Grid thick = scenes::unit_grid(21, 23, 19);
    for (const auto& [source, output] :
         {std::array{thin, thick}, std::array{thick, thin}, std::array{thin, thin}}) {
      for (const PixelType type : {PixelType::float32, PixelType::float64}) {
        SCOPED_TRACE(std::to_string(ones) + name_of(type));
        const Solid solid =
            box_to_box(source, box_of(source, 0.1), output, box_of(output, 0.15), {3, 2, 3});
        worst = std::max(worst, expect_laws(solid, type).evaluation);
      }
    }
  }
  found("evaluation", worst);
}

/// Jitter shears long cells: entries up to 4 in float32. Found: evaluation 3.8e-6.
TEST_P(WarpStressSize, AxesOf65536VoxelsKeepTheLaws) {
  double worst = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    SCOPED_TRACE(axis);
    Grid grid = scenes::unit_grid(5, 5, 5);
    grid.dims[axis] = 65536;
    std::array<int, 3> cells = {2, 2, 2};
    cells[axis] = 512;
    const Solid solid = box_to_box(grid, box_of(grid, 0.6), grid, box_of(grid, 0.3), cells);
    worst = std::max(worst, expect_laws(solid, PixelType::float32, {}, 31).evaluation);
  }
  found("evaluation", worst);
}

/// A million voxels into the source, where the resolution of float32 is a sixteenth of a voxel.
/// Found: evaluation 1.1e-6.
TEST_P(WarpStressSize, AMillionVoxelsIntoTheSourceKeepTheLaws) {
  Grid source = scenes::unit_grid(1'000'032, 5, 5);
  const std::array<Point3, 2> rest = {{{1e6, 0.3, 0.3}, {1e6 + 30, 3.7, 3.7}}};
  const Grid output = scenes::unit_grid(30, 26, 22);
  const Solid solid = box_to_box(source, rest, output, box_of(output, 2.2), {4, 3, 3});

  found("evaluation", expect_laws(solid, PixelType::float32).evaluation);
}

/// One tetrahedron with voxel centers on its faces, edges and nodes; it owns them too.
TEST_P(WarpStressSize, OneTetrahedronOwnsItsClosedShape) {
  const Grid grid = scenes::unit_grid(24, 24, 24);
  for (const double size : {0.0625, 1.0, 20.0}) {
    scenes::Scene scene = {"one", {}, {}, grid, grid};
    scene.mesh.rest_positions = {{3, 3, 3}, {18, 4, 3}, {4, 19, 5}, {3, 3, 20}};
    scene.mesh.tets = {{0, 1, 2, 3}};
    scene.deformed = {{2, 2, 2}, {2 + size, 2, 2}, {2, 2 + size, 2}, {2, 2, 2 + size}};

    const Probed probed = probe(scene, GetParam(), PixelType::float32);

    // Whole points with i + j + k <= size in the corner of the octant.
    const auto n = static_cast<std::int64_t>(size);
    EXPECT_EQ(probed.counts.covered, (n + 1) * (n + 2) * (n + 3) / 6);
    expect_owners(scene, probed.owner, 1);
    expect_position_laws(position_errors(probed, scene));
  }
}

/// A tetrahedron 2^20 voxels wide, the widest there may be, over a small window. Found: evaluation
/// 7.2e-8, nearly all of it the sample's own rounding.
TEST_P(WarpStressSize, OneTetrahedronMayBeAMillionVoxelsWide) {
  const Grid grid = scenes::unit_grid(24, 24, 24);
  const double reach = 0x1p18;
  scenes::Scene scene = {"wide", {}, {}, grid, grid};
  scene.mesh.rest_positions = {{1, 2, 1}, {22, 4, 3}, {4, 21, 5}, {3, 3, 20}};
  scene.mesh.tets = {{0, 1, 2, 3}};
  scene.deformed = {{0.1 - reach, -reach, -reach},
                    {3 * reach, -reach, -reach},
                    {-reach, 3 * reach - 0.3, -reach},
                    {-reach, -reach, 3 * reach - 0.7}};

  for (const PixelType type : {PixelType::float32, PixelType::float64}) {
    const Probed probed = probe(scene, GetParam(), type);
    const PositionErrors errors = position_errors(probed, scene);

    expect_position_laws(errors);
    expect_owners(scene, probed.owner, 1);
    EXPECT_GT(probed.counts.covered, 100);
    found(std::string("evaluation_") + name_of(type), errors.evaluation);
  }
}

/// Half a voxel each, most of them own nothing. Folds are counted by the reference, whose owners
/// must be the same. Found: evaluation 1.7e-6.
TEST_P(WarpStressSize, TwoMillionTetrahedraKeepTheLaws) {
  const Grid grid = scenes::unit_grid(96, 96, 96);
  const Solid solid = turned_solid(grid, grid, {74, 74, 74});
  ASSERT_GT(solid.scene.mesh.tets.size(), 2'000'000u);
  WarpOptions options;
  options.count_folded = true;
  const Volume source = scenes::wavy_volume(grid, PixelType::uint8);
  const Warped reference = run_warp(source, solid.scene, Backend::reference, options);

  const Probed probed = probe(solid.scene, GetParam(), PixelType::float32);
  const PositionErrors errors = position_errors(probed, solid.scene, 5);

  expect_position_laws(errors);
  const CoverageErrors coverage = coverage_errors(solid, probed.owner, 0x1p-19, {}, grid.dims);
  EXPECT_EQ(coverage.holes, 0);
  EXPECT_EQ(coverage.spills, 0);
  EXPECT_EQ(reference.counts.folded, 0);
  EXPECT_TRUE(probed.owner == reference.owner);
  found("evaluation", errors.evaluation);
}
}  // namespace
}  // namespace tetwarp::test

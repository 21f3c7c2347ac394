/// @file test_warp_stress_grids.cpp
/// Difficult grids: tiny and huge units, far from zero, a thousand times finer along
/// one axis. Numbers behind "found" are the largest seen on cpu.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "tests/support/warp_laws.hpp"

namespace tetwarp::test {
namespace {
class WarpStressGrids : public WarpLaws {};
INSTANTIATE_TEST_SUITE_P(Backends, WarpStressGrids, each_backend, name_of_backend);

Solid oblong_solid() {
  Grid grid = scenes::unit_grid(28, 26, 30);
  grid.spacing = {0.7, 0.9, 0.6};
  grid.origin = {-33.3, 12.1, 5.7};
  return turned_solid(grid, grid, {3, 3, 4});
}

/// The world measured in other units.
Solid in_units(Solid solid, double unit) {
  const auto scale = [unit](Point3& p) {
    for (double& x : p) x *= unit;
  };
  for (Grid* grid : {&solid.scene.source_grid, &solid.scene.output_grid}) {
    scale(grid->origin);
    scale(grid->spacing);
  }
  std::ranges::for_each(solid.scene.mesh.rest_positions, scale);
  std::ranges::for_each(solid.scene.deformed, scale);
  scale(solid.low);
  scale(solid.high);
  solid.undone = [undone = solid.undone, unit](const Point3& p) {
    const Point3 q = undone({p[0] / unit, p[1] / unit, p[2] / unit});
    return Point3{q[0] * unit, q[1] * unit, q[2] * unit};
  };
  return solid;
}

/// The same scene at another place in the world.
Solid at_offset(Solid solid, const Point3& offset) {
  const auto move = [&](Point3& p) {
    for (std::size_t axis = 0; axis < 3; ++axis) p[axis] += offset[axis];
  };
  move(solid.scene.source_grid.origin);
  move(solid.scene.output_grid.origin);
  std::ranges::for_each(solid.scene.mesh.rest_positions, move);
  std::ranges::for_each(solid.scene.deformed, move);
  move(solid.low);
  move(solid.high);
  solid.undone = [undone = solid.undone, offset](const Point3& p) {
    const Point3 q = undone({p[0] - offset[0], p[1] - offset[1], p[2] - offset[2]});
    return Point3{q[0] + offset[0], q[1] + offset[1], q[2] + offset[2]};
  };
  return solid;
}

/// A warp of `solid` has the same bits as one of `other`, the same scene.
void expect_same_bits(Backend backend, const Solid& solid, const Solid& other) {
  Volume source = scenes::wavy_volume(solid.scene.source_grid, PixelType::float32);
  const Warped expected = run_warp(source, solid.scene, backend);
  source.grid = other.scene.source_grid;
  const Warped warped = run_warp(source, other.scene, backend);

  EXPECT_EQ(warped.volume.data, expected.volume.data);
  EXPECT_EQ(warped.owner, expected.owner);
  EXPECT_GT(warped.counts.covered, 1000);
}

/// Found: evaluation 1.4e-6 in every unit.
TEST_P(WarpStressGrids, UnitsFromAMillionthToAMillionKeepTheLaws) {
  double worst = 0;
  for (int decade = -6; decade <= 6; ++decade) {
    SCOPED_TRACE(decade);
    const Solid solid = in_units(oblong_solid(), std::pow(10.0, decade));
    worst = std::max(worst, expect_laws(solid, PixelType::float32).evaluation);
  }
  found("evaluation", worst);
}

/// A power of two changes exponents only.
TEST_P(WarpStressGrids, UnitsOfPowersOfTwoKeepEveryBit) {
  for (const int power : {-40, -20, -1, 1, 20, 40}) {
    SCOPED_TRACE(power);
    expect_same_bits(GetParam(), oblong_solid(), in_units(oblong_solid(), std::ldexp(1, power)));
  }
}

/// Found: evaluation 1.6e-6, rounding 1.2e-6 at every distance. At 1e9 voxels float64 itself
/// holds positions to 1e-7 of a voxel.
TEST_P(WarpStressGrids, GridsAThousandToABillionVoxelsAwayKeepTheLaws) {
  double evaluation = 0, rounding = 0;
  for (int decade = 3; decade <= 9; ++decade) {
    SCOPED_TRACE(decade);
    const double voxels = std::pow(10.0, decade);
    const Solid solid = at_offset(oblong_solid(), {0.7 * voxels, -0.9 * voxels, 0.6 * voxels});
    const PositionErrors errors = expect_laws(solid, PixelType::float32);
    evaluation = std::max(evaluation, errors.evaluation);
    rounding = std::max(rounding, errors.rounding);
  }
  found("evaluation", evaluation);
  found("rounding", rounding);
}

/// Nodes on quanta and whole voxels between: float64 holds every position exactly, up to 2^30.
TEST_P(WarpStressGrids, ExactOffsetsKeepEveryBit) {
  const Grid grid = scenes::unit_grid(28, 26, 30);
  Solid solid = turned_solid(grid, grid, {3, 3, 4});
  for (auto* nodes : {&solid.scene.mesh.rest_positions, &solid.scene.deformed}) {
    for (Point3& p : *nodes) {
      for (double& x : p) x = std::nearbyint(x * 0x1p20) * 0x1p-20;
    }
  }
  for (const double voxels : {1e3, 1e6, 1e9}) {
    SCOPED_TRACE(voxels);
    expect_same_bits(GetParam(), solid, at_offset(solid, {voxels, -voxels, voxels + 7}));
  }
}

/// The region a thousand to a billion voxels into the output grid: its indices are large, not its
/// world positions. Found: evaluation 1.5e-6, rounding 1.1e-6. At 1e9 voxels an index has lost
/// 1e-7 before it is rounded to quanta.
TEST_P(WarpStressGrids, RegionsFarIntoTheGridKeepTheLaws) {
  const Grid source = scenes::unit_grid(28, 26, 30);
  double evaluation = 0, rounding = 0;
  for (int decade = 3; decade <= 9; ++decade) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      SCOPED_TRACE(std::to_string(decade) + " axis " + std::to_string(axis));
      const auto voxels = static_cast<std::int64_t>(std::pow(10.0, decade));
      Grid output = source;
      output.dims[axis] = std::int64_t{1} << 30;
      output.origin[axis] = -static_cast<double>(voxels);
      WarpOptions options;
      options.region = Region{{0, 0, 0}, source.dims};
      options.region->begin[axis] += voxels;
      options.region->end[axis] += voxels;

      const Solid solid = turned_solid(source, output, {3, 3, 3});
      const PositionErrors errors = expect_laws(solid, PixelType::float32, options);

      evaluation = std::max(evaluation, errors.evaluation);
      rounding = std::max(rounding, errors.rounding);
    }
  }
  found("evaluation", evaluation);
  found("rounding", rounding);
}

/// A source, an output or both a thousand times finer along one axis than along the others: maps
/// with entries of 1000 and of 1/1000. Found: evaluation 1.3e-6.
TEST_P(WarpStressGrids, SpacingRatiosOfAThousandKeepTheLaws) {
  double worst = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Grid even = scenes::unit_grid(12, 12, 12);
    Grid fine = even, other = even;
    fine.dims[axis] = 5001;
    fine.spacing[axis] = 1e-3;
    other.dims[(axis + 1) % 3] = 5001;
    other.spacing[(axis + 1) % 3] = 1e-3;
    struct Pair {
      const Grid& source;
      const Grid& output;
      std::size_t stride;
    };
    for (const Pair& grids :
         {Pair{fine, even, 1}, {even, fine, 23}, {fine, fine, 23}, {fine, other, 23}}) {
      SCOPED_TRACE("axis " + std::to_string(axis));
      const Solid solid = turned_solid(grids.source, grids.output, {3, 2, 3});
      worst = std::max(worst, expect_laws(solid, PixelType::float32, {}, grids.stride).evaluation);
    }
  }
  found("evaluation", worst);
}
}  // namespace
}  // namespace tetwarp::test

/// @file warp_laws.hpp
/// Laws of every warp: positions within their bounds, no voxel inside the mesh without owner, none
/// outside with one, none with two, owners by the definition.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/support/each_backend.hpp"
#include "tests/support/position_errors.hpp"
#include "tests/support/solid_scenes.hpp"

namespace tetwarp::test {

class WarpLaws : public EachBackend {
 protected:
  static void expect_position_laws(const PositionErrors& errors) {
    EXPECT_LE(errors.evaluation_share, 1);
    EXPECT_LE(errors.rounding_share, 1);
    EXPECT_EQ(errors.strays, 0);
    EXPECT_GT(errors.voxels, 0);
  }

  /// All laws; positions are checked in every `stride`-th voxel.
  PositionErrors expect_laws(const Solid& solid,
                             PixelType type,
                             WarpOptions options = {},
                             std::size_t stride = 1) const {
    options.count_folded = true;
    const Probed probed = probe(solid.scene, GetParam(), type, options);
    const PositionErrors errors = position_errors(probed, solid.scene, stride);
    expect_position_laws(errors);
    const CoverageErrors coverage =
        coverage_errors(solid, probed.owner, margin_of(probed, solid), probed.begin, probed.dims);
    EXPECT_EQ(coverage.holes, 0);
    EXPECT_EQ(coverage.spills, 0);
    EXPECT_EQ(probed.counts.folded, 0);
    EXPECT_GT(coverage.inside, 0);
    return errors;
  }

  /// Owners of every `stride`-th voxel by the definition.
  static void expect_owners(const scenes::Scene& scene,
                            const std::vector<std::int32_t>& tet,
                            std::size_t stride) {
    const auto tets = tets_of(scene.output_grid, scene.mesh, scene.deformed);
    const auto& n = scene.output_grid.dims;
    for (std::size_t v = 0; v < tet.size(); v += stride) {
      const auto voxel = static_cast<std::int64_t>(v);
      const std::int64_t row = voxel / n[0];
      const Quanta center = voxel_center(voxel % n[0], row % n[1], row / n[1]);
      ASSERT_EQ(tet[v], owner_of(tets, center)) << "voxel " << v;
    }
  }

 private:
  /// How far rounding may move the hull and world_of() a voxel: a quantum per node, and float64 of
  /// the largest coordinates.
  static double margin_of(const Probed& probed, const Solid& solid) {
    const Grid& grid = solid.scene.output_grid;
    double margin = 0, farthest = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto last = static_cast<double>(probed.begin[axis] + probed.dims[axis]);
      margin = std::max(margin, 0x1p-19 * grid.spacing[axis]);
      farthest = std::max(farthest, std::abs(grid.origin[axis]) + grid.spacing[axis] * last);
    }
    return margin + 0x1p-49 * farthest;
  }
};

}  // namespace tetwarp::test

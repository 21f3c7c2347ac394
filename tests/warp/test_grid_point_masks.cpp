/// @file test_grid_point_masks.cpp
/// Warps whose cells are culled by masks of grid points have the bits of warps culled by planes.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "host/base/warp_backend.hpp"
#include "tests/support/hex_scenes.hpp"
#include "tests/support/skip_series.hpp"
#include "tests/support/warp_run.hpp"

namespace tetwarp::test {
namespace {
class GridPointMasksOption : public ::testing::TestWithParam<Backend> {
 protected:
  void SetUp() override {
    const BackendStatus status = cuda_status(0);
    if (GetParam() == Backend::cuda && !status.usable) GTEST_SKIP() << status.reason;
  }

  static WarpOptions with_masks(WarpOptions options = {}) {
    options.backend = GetParam();
    options.expert.skip.grid_point_masks = true;
    return options;
  }
  static WarpOptions without_masks(WarpOptions options = {}) {
    options.backend = GetParam();
    return options;
  }
};
INSTANTIATE_TEST_SUITE_P(Backends,
                         GridPointMasksOption,
                         ::testing::Values(Backend::cpu, Backend::cuda),
                         [](const auto& info) { return std::string(name_of(info.param)); });

/// @returns the counts of the warp with masks
Counts expect_same(const scenes::Scene& scene,
                   const WarpOptions& with,
                   const WarpOptions& without) {
  const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::int16);
  const Warped planes = run_warp(source, scene, without.backend, without);
  const Warped masks = run_warp(source, scene, with.backend, with);
  EXPECT_TRUE(masks.owner == planes.owner) << scene.name;
  EXPECT_TRUE(masks.mask == planes.mask) << scene.name;
  EXPECT_TRUE(masks.volume.data == planes.volume.data) << scene.name;
  EXPECT_EQ(masks.counts.covered, planes.counts.covered) << scene.name;
  EXPECT_EQ(masks.counts.candidate_pairs, planes.counts.candidate_pairs) << scene.name;
  EXPECT_EQ(masks.counts.pairs_rejected + masks.counts.pairs_accepted + masks.counts.pairs_partial,
            masks.counts.candidate_pairs)
      << scene.name;
  return masks.counts;
}

/// A lattice turned by 30 degrees about z, `offset` voxels from the origin of both grids.
scenes::Scene turned_scene(double offset) {
  scenes::Scene scene = scenes::adversarial_scene("rotated", 48);
  for (Point3& p : scene.mesh.rest_positions) p[1] += offset * scene.source_grid.spacing[1];
  for (Point3& p : scene.deformed) p[1] += offset * scene.source_grid.spacing[1];
  scene.source_grid.origin[1] += offset * scene.source_grid.spacing[1];
  scene.output_grid.origin[1] += offset * scene.source_grid.spacing[1];
  return scene;
}

TEST_P(GridPointMasksOption, GivesTheBitsOfPlanesOnEveryScene) {
  std::int64_t rejected = 0, accepted = 0;
  for (const scenes::Scene& scene : scenes::adversarial_scenes(28)) {
    const Counts counts = expect_same(scene, with_masks(), without_masks());
    rejected += counts.pairs_rejected;
    accepted += counts.pairs_accepted;
  }
  EXPECT_GT(rejected, 1000);
  EXPECT_GT(accepted, 0);
}

TEST_P(GridPointMasksOption, GivesTheBitsOfPlanesFarFromTheOrigin) {
  for (const double offset : {1e3, 1e6, -1e9}) {
    const Counts counts = expect_same(turned_scene(offset), with_masks(), without_masks());

    EXPECT_GT(counts.pairs_rejected, 0) << offset;
  }
}

/// One tetrahedron that holds cells as a whole, by each combination of switches.
TEST_P(GridPointMasksOption, GivesTheVerdictsThatAreSwitchedOn) {
  const Grid grid = scenes::unit_grid(64, 64, 64);
  scenes::Scene scene = {"large", {}, {}, grid, grid};
  scene.mesh.rest_positions = {{-1, -1, -1}, {90, -1, -1}, {-1, 90, -1}, {-1, -1, 90}};
  scene.mesh.tets = {{0, 1, 2, 3}};
  scene.deformed = {{-2, -1, -1.5}, {80, 1, -1}, {-1, 85, -2}, {-3, -1, 70}};
  for (const bool rejects : {true, false}) {
    for (const bool accepts : {true, false}) {
      WarpOptions options;
      options.expert.skip.rejected_cells = rejects;
      options.expert.skip.accepted_cells = accepts;
      const Counts counts = expect_same(scene, with_masks(options), without_masks(options));

      EXPECT_EQ(counts.pairs_rejected > 0, rejects);
      EXPECT_EQ(counts.pairs_accepted > 0, accepts);
    }
  }
}

TEST_P(GridPointMasksOption, GivesTheBitsOfPlanesWithOtherOptions) {
  const scenes::Scene scene = scenes::adversarial_scene("waved", 40);
  for (const Intensity intensity : {Intensity::density, Intensity::conservative}) {
    const WarpOptions options{.intensity = intensity};
    expect_same(scene, with_masks(options), without_masks(options));
  }
  WarpOptions options{.filter = Filter::cubic, .antialias = true, .outside = Outside::identity};
  options.region = Region{{3, 5, 2}, {37, 30, 33}};
  expect_same(scenes::adversarial_scene("rotated", 40), with_masks(options),
              without_masks(options));
}

TEST_P(GridPointMasksOption, GivesTheBitsOfPlanesWithHexahedra) {
  const Grid grid = scenes::unit_grid(64, 64, 64);
  for (const int parts : {1, 2}) {
    const HexBox box = hex_box({2, 2, 1}, {-0.5, -0.5, -0.5}, {63.5, 63.5, 63.5}, bent(4), parts);

    const Counts counts = expect_same({"hexahedra", box.mesh, box.deformed, grid, grid},
                                      with_masks(), without_masks());

    EXPECT_GT(counts.pairs_rejected, 0);
  }
}

/// Parts of the mesh move, or nothing; each step updates the one before, in one target or in two.
TEST_P(GridPointMasksOption, GivesTheBitsOfPlanesInSeries) {
  for (const char* name : {"waved", "rotated", "soup"}) {
    const scenes::Scene scene = scenes::adversarial_scene(name, 24);
    const std::vector<Volume> sources = {
        scenes::wavy_volume(scene.source_grid, PixelType::float32)};
    Series masks(sources, scene, with_masks()), planes(sources, scene, without_masks());
    std::int64_t unchanged = 0, step = 0;
    for (const auto& positions : partial_motions(scene, 17)) {
      const Counts counts = masks.step(positions);
      planes.step(positions, false);

      unchanged += counts.tets_unchanged;
      EXPECT_TRUE(masks.has_bits_of(planes)) << name << ", step " << step;
      if (step++ % 3 == 1) masks.swap_targets();
    }
    EXPECT_GT(unchanged, 0) << name;
  }
}

TEST_P(GridPointMasksOption, HasATimeOfItsOwn) {
  const scenes::Scene scene = scenes::adversarial_scene("rotated", 40);
  const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::uint8);
  const auto seconds = [&](WarpOptions options) {
    options.stage_times = true;
    options.output_grid = scene.output_grid;
    Warper warper(source, scene.mesh, options);
    warper.step(scene.deformed);
    return warper.report().timings.mask;
  };
  WarpOptions unused = with_masks();
  unused.expert.skip.rejected_cells = unused.expert.skip.accepted_cells = false;

  EXPECT_GT(seconds(with_masks()), 0);
  EXPECT_EQ(seconds(without_masks()), 0);
  EXPECT_EQ(seconds(unused), 0);
}
}  // namespace
}  // namespace tetwarp::test

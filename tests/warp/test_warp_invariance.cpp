/// @file test_warp_invariance.cpp
/// The bits of a warp do not depend on threads, batches, regions, skipped work or other sources.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/each_scene.hpp"
#include "tests/support/warp_run.hpp"

namespace tetwarp::test {
namespace {
/// Together these scenes take every path of the raster stage.
const SceneNames raster_scenes = {"aligned", "waved", "tiny", "soup", "overlapping", "other_grid"};

class WarpInvariance : public EachScene<40> {};
INSTANTIATE_TEST_SUITE_P(Scenes, WarpInvariance, ::testing::ValuesIn(raster_scenes), scene_name);

TEST_P(WarpInvariance, AnyNumberOfThreadsGivesTheSameBitsAndCounts) {
  const Volume source = scenes::wavy_volume(scene().source_grid, PixelType::int16, 2);
  WarpOptions options;
  options.count_folded = true;
  options.threads = 1;
  const Warped alone = run_warp(source, scene(), Backend::cpu, options);
  for (const int threads : {2, 7}) {
    options.threads = threads;
    const Warped together = run_warp(source, scene(), Backend::cpu, options);

    EXPECT_TRUE(is_same(alone, together)) << threads;
    EXPECT_EQ(alone.counts.inside_tests, together.counts.inside_tests);
    EXPECT_EQ(alone.counts.exact_tests, together.counts.exact_tests);
    EXPECT_EQ(alone.counts.folded, together.counts.folded);
  }
}

/// 0: all on; 1, 2, 3: one of rejected, accepted, copied off; 4: all off.
WarpOptions without(int which) {
  WarpOptions options;
  options.expert.skip.rejected_cells = which != 1 && which != 4;
  options.expert.skip.accepted_cells = which != 2 && which != 4;
  options.expert.skip.copied_voxels = which != 3 && which != 4;
  options.outside = Outside::identity;
  return options;
}

TEST_P(WarpInvariance, SkippingWorkGivesTheSameBitsAndIsCounted) {
  const Volume source = scenes::wavy_volume(scene().source_grid, PixelType::float32);
  const Warped all = run_warp(source, scene(), Backend::cpu, without(0));

  for (const int which : {1, 2, 3, 4}) {
    EXPECT_TRUE(is_same(all, run_warp(source, scene(), Backend::cpu, without(which)))) << which;
  }

  const Counts no_rejection = run_warp(source, scene(), Backend::cpu, without(1)).counts;
  const Counts no_acceptance = run_warp(source, scene(), Backend::cpu, without(2)).counts;
  const Counts no_copies = run_warp(source, scene(), Backend::cpu, without(3)).counts;
  EXPECT_EQ(no_rejection.pairs_rejected, 0);
  EXPECT_EQ(no_acceptance.pairs_accepted, 0);
  EXPECT_EQ(no_copies.voxels_copied, 0);
  EXPECT_LE(all.counts.inside_tests, no_rejection.inside_tests);
  EXPECT_LE(all.counts.inside_tests, no_acceptance.inside_tests);
}

TEST(WarpSkips, HaveSomethingToSkip) {
  Counts sum;
  for (const std::string& name : raster_scenes) {
    const scenes::Scene scene = scenes::adversarial_scene(name, 40);
    const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::uint8);
    sum += run_warp(source, scene, Backend::cpu, without(0)).counts;
  }
  EXPECT_GT(sum.pairs_rejected, 0);
  EXPECT_GT(sum.pairs_accepted, 0);
  EXPECT_GT(sum.voxels_copied, 0);
}

TEST_P(WarpInvariance, ARegionIsTheCropOfTheWhole) {
  const scenes::Scene& scene = this->scene();
  const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::float32);
  const auto& n = scene.output_grid.dims;
  WarpOptions options;
  options.outside = Outside::identity;
  const Warped whole = run_warp(source, scene, Backend::cpu, options);

  for (const Region& region :
       {Region{{3, 5, 1}, {22, 19, 18}}, Region{{8, 16, 0}, {24, 24, 8}},
        Region{{15, 7, 31}, {n[0], n[1], n[2]}}, Region{{20, 20, 20}, {21, 21, 21}}}) {
    options.region = region;
    const Warped part = run_warp(source, scene, Backend::cpu, options);

    std::size_t v = 0;
    bool same = true;
    for (std::int64_t k = region.begin[2]; k < region.end[2]; ++k) {
      for (std::int64_t j = region.begin[1]; j < region.end[1]; ++j) {
        for (std::int64_t i = region.begin[0]; i < region.end[0]; ++i, ++v) {
          const auto w = static_cast<std::size_t>((k * n[1] + j) * n[0] + i);
          same = same && part.owner[v] == whole.owner[w] && part.mask[v] == whole.mask[w] &&
                 part.volume.samples<float>()[v] == whole.volume.samples<float>()[w];
        }
      }
    }
    EXPECT_EQ(v, part.owner.size());
    EXPECT_TRUE(same) << "from " << region.begin[0];
    const Point3 begin = {static_cast<double>(region.begin[0]),
                          static_cast<double>(region.begin[1]),
                          static_cast<double>(region.begin[2])};
    EXPECT_EQ(part.volume.grid.origin, scene.output_grid.world_of(begin));
  }
}

TEST_P(WarpInvariance, StepsOfABatchEqualStepsAlone) {
  const scenes::Scene& scene = this->scene();
  const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::uint8);
  WarpOptions options;
  options.backend = Backend::cpu;
  options.output_grid = scene.output_grid;
  Warper warper(source, scene.mesh, options);
  std::int64_t covered = 0;
  for (const double amplitude : {0.0, 4.0, 1.0, 1.0}) {
    scenes::Scene step = scene;
    step.deformed = scenes::waved(scene.deformed, amplitude, 51);

    const Warped batch = run_step(warper, source, step.deformed);
    const Warped alone = run_warp(source, step, Backend::cpu);

    EXPECT_TRUE(is_same(batch, alone)) << amplitude;
    EXPECT_EQ(batch.counts.inside_tests, alone.counts.inside_tests);
    covered += alone.counts.covered;
  }
  EXPECT_EQ(warper.report().counts.covered, covered);
  EXPECT_EQ(warper.report().steps.size(), 4u);
  EXPECT_EQ(warper.report().steps[3].step, 3);
}

TEST_P(WarpInvariance, SeveralSourcesAtOnceEqualOneAtATime) {
  const scenes::Scene& scene = this->scene();
  const std::array<Volume, 3> sources = {
      scenes::wavy_volume(scene.source_grid, PixelType::float32),
      scenes::wavy_volume(scene.source_grid, PixelType::int16, 3),
      scenes::wavy_volume(scene.source_grid, PixelType::float64)};
  WarpOptions options;
  options.output_grid = scene.output_grid;
  options.backend = Backend::cpu;
  const std::vector<VolumeView> views(sources.begin(), sources.end());
  Warper warper(views, scene.mesh, options);
  std::vector<Volume> outputs;
  std::vector<void*> pointers;
  for (const Volume& source : sources) {
    outputs.push_back(make_volume(warper.output_grid(), source.type, source.components));
    pointers.push_back(outputs.back().data.data());
  }
  std::vector<std::int32_t> tet(static_cast<std::size_t>(warper.output_grid().voxel_count()));

  const StepReport report =
      warper.step(scene.deformed, {.volumes = pointers, .mask = nullptr, .owner = tet.data()});

  for (std::size_t s = 0; s < sources.size(); ++s) {
    const Warped alone = run_warp(sources[s], scene, Backend::cpu);
    EXPECT_EQ(outputs[s].data, alone.volume.data) << s;
    EXPECT_EQ(tet, alone.owner);
    EXPECT_EQ(report.counts.covered, alone.counts.covered);
  }
}

/// The short forms give the volume that the long one gives, under the source's name.
TEST(WarpForms, AgreeWithEachOther) {
  const scenes::Scene scene = scenes::adversarial_scene("waved", 24);
  Volume source = scenes::wavy_volume(scene.source_grid, PixelType::float32);
  source.name = "density";
  const Warped expected = run_warp(source, scene, Backend::cpu);
  WarpOptions options;
  options.backend = Backend::cpu;

  const WarpResult result = warp(source, scene.mesh, scene.deformed, options);
  const Volume volume = Warper(source, scene.mesh, options).step(scene.deformed);

  EXPECT_EQ(result.volume.data, expected.volume.data);
  EXPECT_EQ(volume.data, expected.volume.data);
  EXPECT_EQ(result.volume.name, "density");
  EXPECT_EQ(result.report.backend, Backend::cpu);
  EXPECT_EQ(result.report.backend_reason, "requested");
  EXPECT_EQ(result.report.position_quantum, 0x1p-20);
}
}  // namespace
}  // namespace tetwarp::test

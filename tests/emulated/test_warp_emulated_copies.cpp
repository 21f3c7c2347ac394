/// @file test_warp_emulated_copies.cpp
/// What steps copy from the emulated device: only the slices and rows that they change; and steps
/// whose buffers are too small, which run again with larger ones.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/skip_series.hpp"

#include "tests/emulated/device_calls.hpp"

namespace tetwarp::test {
namespace {
WarpOptions options_of(Backend backend, const Region& region) {
  WarpOptions options;
  options.backend = backend;
  options.region = region;
  options.expert.skip.unchanged_tets = backend == Backend::cuda;
  return options;
}

class EmulatedCopies : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Scenes,
                         EmulatedCopies,
                         ::testing::Values("waved", "outside", "aligned", "other_grid"),
                         [](const auto& info) { return std::string(info.param); });

TEST_P(EmulatedCopies, AreOfWhatAStepChanges) {
  const scenes::Scene scene = scenes::adversarial_scene(GetParam(), 40);
  const std::vector<Volume> sources = {scenes::wavy_volume(scene.source_grid, PixelType::int16, 2),
                                       scenes::wavy_volume(scene.source_grid, PixelType::float64)};
  for (const Region& region :
       {Region{{0, 0, 0}, scene.output_grid.dims}, Region{{3, 5, 1}, {33, 30, 34}}}) {
    Series anew(sources, scene, options_of(Backend::cpu, region));
    Series far(sources, scene, options_of(Backend::cuda, region));
    anew.fields = far.fields = FieldBuffers();  // none
    const std::size_t all = far.mask.size() * (4 + 8 + 1 + 4);
    constexpr std::size_t counts = 8192, few_counts = 1024;  // that the host reads besides
    bool saves = false;
    for (const auto& positions : partial_motions(scene, 61)) {
      simt::Device::only().take_copied();

      const Counts report = far.step(positions);
      const std::size_t bytes = simt::Device::only().take_copied().to_host;
      anew.step(positions);

      EXPECT_EQ(far.mask, anew.mask);
      EXPECT_EQ(far.owner, anew.owner);
      EXPECT_LE(bytes, all + counts);
      if (report.cells_unchanged == 0) {
        EXPECT_GE(bytes, all);
      }
      if (report.cells_unchanged == report.cells) {
        EXPECT_LE(bytes, few_counts);
      }
      saves = saves || (bytes > few_counts && bytes < all);
    }
    EXPECT_TRUE(saves);
  }
}

/// A mesh that grows needs more pairs than the buffers of the first step have room for.
TEST(EmulatedSteps, AreRunAgainWhereBuffersWereTooSmall) {
  const scenes::Scene scene = scenes::adversarial_scene("waved", 40);
  const std::vector<Volume> sources = {scenes::wavy_volume(scene.source_grid, PixelType::float32)};
  const Region whole{{0, 0, 0}, scene.output_grid.dims};
  Series anew(sources, scene, options_of(Backend::cpu, whole));
  Series far(sources, scene, options_of(Backend::cuda, whole));
  anew.fields = far.fields = FieldBuffers();  // none
  for (const double scale : {0.02, 1.0, 0.3, 1.0}) {
    auto positions = scene.deformed;
    for (Point3& p : positions) {
      for (double& x : p) x = 20 + scale * (x - 20);
    }

    far.step(positions);
    anew.step(positions);

    EXPECT_EQ(far.mask, anew.mask) << scale;
    EXPECT_EQ(far.owner, anew.owner) << scale;
  }
}
}  // namespace
}  // namespace tetwarp::test

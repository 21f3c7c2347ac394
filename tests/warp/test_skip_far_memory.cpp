/// @file test_skip_far_memory.cpp
/// Series on an executor whose memory is separate from the caller's, as a device's is: only the
/// slices and rows that a step changes are copied back, and a step whose buffers are too small runs
/// again with larger ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "host/exec/exec_cpu.hpp"
#include "host/warp/cpu/cell_raster_cpu.hpp"
#include "host/warp/step_queue.hpp"
#include "host/warp/warp_pipeline.hpp"
#include "tests/scenes/skip_series.hpp"

namespace tetwarp::test {
namespace {
/// Host threads with memory separate from the caller's.
class FarExec : public CpuExec {
 public:
  static constexpr bool reads_are_free = false;
  using CpuExec::CpuExec;

  template <class T>
  View<const T> resident(const char*, const T* host, std::int64_t size, Buffer<T>& buffer) {
    buffer.reserve(size);
    std::copy_n(host, size, buffer.view(size).data);
    return buffer.const_view(size);
  }
  template <class T>
  T* writable(T*, std::int64_t size, Buffer<T>& buffer) {
    buffer.reserve(size);
    return buffer.view(size).data;
  }
  template <class T>
  void download(const char*, View<const T> from, T* to) {
    std::copy_n(from.data, from.size, to);
    *downloaded_ += from.size * static_cast<std::int64_t>(sizeof(T));
  }

  /// As for memory that is not page-locked: parts of an output are copied one by one.
  bool downloads_async(const void*) const { return false; }

  /// From now on adds the bytes that are copied back to `bytes`.
  void count_in(std::int64_t& bytes) { downloaded_ = &bytes; }

 private:
  std::int64_t* downloaded_ = nullptr;
};

StepReport step(StepQueue& far, const std::vector<Point3>& positions, const WarpTarget& target) {
  far.begin(positions, target, {});
  return far.finish();
}

/// Steps of a region on far memory; `bytes` counts what is copied back.
StepQueue far_queue(const std::vector<Volume>& sources,
                    const scenes::Scene& scene,
                    const Region& region,
                    std::int64_t& bytes) {
  WarpPlan plan;
  plan.sources = {sources.begin(), sources.end()};
  plan.mesh = scene.mesh;
  plan.source_region = {{0, 0, 0}, sources.front().grid.dims};
  plan.output_grid = scene.output_grid;
  plan.region = region;
  FarExec exec(1);
  exec.count_in(bytes);
  return StepQueue(std::make_unique<WarpPipeline<FarExec>>(plan, std::move(exec)));
}

class FarMemory : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Scenes,
                         FarMemory,
                         ::testing::Values("waved", "outside", "aligned", "other_grid"),
                         [](const auto& info) { return std::string(info.param); });

TEST_P(FarMemory, KeepsTheResultFromStepToStepAndCopiesBackWhatChanged) {
  const scenes::Scene scene = scenes::adversarial_scene(GetParam(), 40);
  const std::vector<Volume> sources = {scenes::wavy_volume(scene.source_grid, PixelType::int16, 2),
                                       scenes::wavy_volume(scene.source_grid, PixelType::float64)};
  for (const Region& region :
       {Region{{0, 0, 0}, scene.output_grid.dims}, Region{{3, 5, 1}, {33, 30, 34}}}) {
    std::int64_t bytes = 0;
    StepQueue far = far_queue(sources, scene, region, bytes);
    WarpOptions options;
    options.backend = Backend::cpu;
    options.region = region;
    options.skip.unchanged_tets = false;
    Series anew(sources, scene, options), out(sources, scene, options);
    anew.fields = out.fields = FieldBuffers();  // none
    std::vector<void*> pointers;
    for (Volume& volume : out.volumes) pointers.push_back(volume.data.data());
    const WarpTarget target = {.volumes = pointers,
                               .mask = out.mask.data(),
                               .owner = out.owner.data(),
                               .holds_previous = true};
    const std::int64_t all = static_cast<std::int64_t>(out.mask.size()) * (4 + 8 + 1 + 4);
    bool saves = false;
    for (const auto& positions : partial_motions(scene, 61)) {
      bytes = 0;

      const Counts counts = step(far, positions, target).counts;
      anew.step(positions);

      EXPECT_TRUE(out.has_bits_of(anew));
      EXPECT_LE(bytes, all);
      if (counts.cells_unchanged == 0) {
        EXPECT_EQ(bytes, all);
      }
      if (counts.cells_unchanged == counts.cells) {
        EXPECT_EQ(bytes, 0);
      }
      saves = saves || (bytes > 0 && bytes < all);
    }
    EXPECT_TRUE(saves);
  }
}

/// A mesh that grows needs more pairs than the buffers of the first step have room for.
TEST(FarMemorySteps, AreRunAgainWhereBuffersWereTooSmall) {
  const scenes::Scene scene = scenes::adversarial_scene("waved", 40);
  const std::vector<Volume> sources = {scenes::wavy_volume(scene.source_grid, PixelType::float32)};
  std::int64_t bytes = 0;
  StepQueue far = far_queue(sources, scene, {{0, 0, 0}, scene.output_grid.dims}, bytes);
  WarpOptions options;
  options.backend = Backend::cpu;
  Series anew(sources, scene, options), out(sources, scene, options);
  anew.fields = out.fields = FieldBuffers();  // none
  void* const volume = out.volumes[0].data.data();
  const WarpTarget target = {.volumes = std::span(&volume, 1),
                             .mask = out.mask.data(),
                             .owner = out.owner.data(),
                             .holds_previous = true};
  for (const double scale : {0.02, 1.0, 0.3, 1.0}) {
    auto positions = scene.deformed;
    for (Point3& p : positions) {
      for (double& x : p) x = 20 + scale * (x - 20);
    }

    step(far, positions, target);
    anew.step(positions);

    EXPECT_TRUE(out.has_bits_of(anew)) << scale;
  }
}
}  // namespace
}  // namespace tetwarp::test

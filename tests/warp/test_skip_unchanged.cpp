/// @file test_skip_unchanged.cpp
/// A step that updates the one before writes what a step from scratch writes, bit for bit, and
/// touches nothing else.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <tetwarp/error.hpp>

#include "host/base/warp_backend.hpp"
#include "tests/support/each_scene.hpp"
#include "tests/support/skip_series.hpp"

namespace tetwarp::test {
namespace {
/// Back end and name of a scene.
using UpdateCase = std::tuple<Backend, std::string>;

class SkipUnchanged : public ::testing::TestWithParam<UpdateCase> {
 protected:
  void SetUp() override {
    const BackendStatus status = cuda_status(0);
    if (backend() == Backend::cuda && !status.usable) GTEST_SKIP() << status.reason;
    scene_ = scenes::adversarial_scene(std::get<1>(GetParam()), 32);
  }
  static Backend backend() { return std::get<0>(GetParam()); }
  const scenes::Scene& scene() const { return scene_; }

  static WarpOptions options(bool updates) {
    WarpOptions options;
    options.backend = backend();
    options.threads = 1;
    options.count_folded = true;
    options.expert.skip.unchanged_tets = updates;
    return options;
  }

 private:
  scenes::Scene scene_;
};

/// The meshes of tetrahedra small enough to move in part.
const SceneNames moving_scenes = {"identity", "aligned", "waved", "tiny",
                                  "outside",  "oblique", "soup",  "overlapping",
                                  "folded",   "flat",    "far",   "other_grid"};

INSTANTIATE_TEST_SUITE_P(Scenes,
                         SkipUnchanged,
                         ::testing::Combine(::testing::Values(Backend::cpu, Backend::cuda),
                                            ::testing::ValuesIn(moving_scenes)),
                         [](const auto& info) {
                           return std::get<1>(info.param) + "_" + name_of(std::get<0>(info.param));
                         });

std::vector<Volume> sources_of(const scenes::Scene& scene) {
  return {scenes::wavy_volume(scene.source_grid, PixelType::int16),
          scenes::wavy_volume(scene.source_grid, PixelType::float32, 2),
          scenes::wavy_volume(scene.source_grid, PixelType::float64)};
}

void expect_same_description(const Counts& a, const Counts& b, std::size_t step) {
  EXPECT_EQ(a.voxels, b.voxels) << step;
  EXPECT_EQ(a.covered, b.covered) << step;
  EXPECT_EQ(a.outside, b.outside) << step;
  EXPECT_EQ(a.tetrahedra, b.tetrahedra) << step;
  EXPECT_EQ(a.inverted, b.inverted) << step;
  EXPECT_EQ(a.flat, b.flat) << step;
  EXPECT_EQ(a.folded, b.folded) << step;
  EXPECT_EQ(a.cells, b.cells) << step;
}

TEST_P(SkipUnchanged, UpdatesHaveTheBitsOfStepsFromScratch) {
  const std::vector<Volume> sources = sources_of(scene());
  for (const bool whole : {true, false}) {
    WarpOptions on = options(true), off = options(false);
    if (!whole) {
      on.region = off.region = Region{{3, 5, 1}, {26, 24, 27}};
      on.outside = off.outside = Outside::identity;
      on.threads = 2;
    }
    Series updated(sources, scene(), on), anew(sources, scene(), off);
    std::int64_t unchanged_cells = 0, unchanged_tets = 0;
    std::size_t step = 0;
    for (const auto& positions : partial_motions(scene(), 61)) {
      const Counts with = updated.step(positions), without = anew.step(positions);

      EXPECT_TRUE(updated.has_bits_of(anew)) << "step " << step;
      expect_same_description(with, without, step++);
      EXPECT_EQ(without.tets_unchanged, 0);
      EXPECT_EQ(without.cells_unchanged, 0);
      EXPECT_LE(with.inside_tests, without.inside_tests);
      unchanged_cells += with.cells_unchanged;
      unchanged_tets += with.tets_unchanged;
    }
    EXPECT_GT(unchanged_cells, 0);
    EXPECT_GT(unchanged_tets, 0);
  }
}

/// Outputs in new memory, as with Warper::step() into a new volume: tetrahedra that have not moved
/// are not set up again, every cell is written.
TEST_P(SkipUnchanged, BuffersThatDoNotHoldTheStepBeforeAreWrittenWhole) {
  const std::vector<Volume> sources = sources_of(scene());
  Series updated(sources, scene(), options(true)), anew(sources, scene(), options(false));
  std::int64_t unchanged_tets = 0;
  for (const auto& positions : partial_motions(scene(), 67)) {
    for (Volume& volume : updated.volumes) std::ranges::fill(volume.data, std::byte{0x5a});
    std::ranges::fill(updated.mask, 0x5a);
    std::ranges::fill(updated.owner, 0x5a);

    const Counts with = updated.step(positions, false);
    anew.step(positions);

    EXPECT_TRUE(updated.has_bits_of(anew));
    EXPECT_EQ(with.cells_unchanged, 0);
    unchanged_tets += with.tets_unchanged;
  }
  EXPECT_GT(unchanged_tets, 0);
}

/// Every step writes over the result of the step before the last; kept cells are those that have
/// not changed since then, also where some steps use the same target as the step before.
TEST_P(SkipUnchanged, TargetsInTurnsKeepWhatHasNotChangedSince) {
  const std::vector<Volume> sources = sources_of(scene());
  Series updated(sources, scene(), options(true)), anew(sources, scene(), options(false));
  std::int64_t step = 0, inside_tests = 0, inside_tests_anew = 0;
  for (const auto& positions : partial_motions(scene(), 61)) {
    inside_tests += updated.step(positions).inside_tests;
    inside_tests_anew += anew.step(positions).inside_tests;

    EXPECT_TRUE(updated.has_bits_of(anew)) << "step " << step;
    if (++step % 5 != 0) updated.swap_targets();
  }
  EXPECT_LT(inside_tests, inside_tests_anew);
}

/// Kept cells are not written: values that the test puts there stay.
TEST_P(SkipUnchanged, KeptCellsAreNotWritten) {
  if (backend() == Backend::cuda) GTEST_SKIP() << "the device keeps its own copy of the result";
  const std::vector<Volume> sources = sources_of(scene());
  Series updated(sources, scene(), options(true)), anew(sources, scene(), options(false));
  const auto steps = partial_motions(scene(), 61);
  updated.step(steps[0]);
  std::ranges::fill(updated.owner, -99);

  const Counts with = updated.step(steps[1]);
  anew.step(steps[1]);

  const Grid& grid = scene().output_grid;
  std::vector<bool> is_kept(static_cast<std::size_t>(with.cells), true);
  std::int64_t kept_voxels = 0;
  const auto cell_of_voxel = [&](std::size_t v) {
    const auto nx = static_cast<std::size_t>(grid.dims[0]),
               ny = static_cast<std::size_t>(grid.dims[1]);
    return ((v / nx / ny / 8) * ((ny + 7) / 8) + v / nx % ny / 8) * ((nx + 7) / 8) + v % nx / 8;
  };
  for (std::size_t v = 0; v < updated.owner.size(); ++v) {
    if (updated.owner[v] != -99) is_kept[cell_of_voxel(v)] = false;
  }
  for (std::size_t v = 0; v < updated.owner.size(); ++v) {
    kept_voxels += is_kept[cell_of_voxel(v)];
    EXPECT_EQ(updated.owner[v], is_kept[cell_of_voxel(v)] ? -99 : anew.owner[v]);
  }
  EXPECT_EQ(std::ranges::count(is_kept, true), with.cells_unchanged);
}

/// A scene, its sources and a first step done.
struct Started {
  scenes::Scene scene = scenes::adversarial_scene("waved", 32);
  std::vector<Volume> sources = sources_of(scene);
  Series series;
  std::vector<std::vector<Point3>> steps = partial_motions(scene, 61);

  explicit Started(const WarpOptions& options) : series(sources, scene, options) {
    series.step(steps[0]);
  }
};

WarpOptions on_cpu() {
  WarpOptions options;
  options.backend = Backend::cpu;
  return options;
}

TEST(SkipUnchangedSteps, AStepThatWasStoppedIsNotBuiltOn) {
  for (const bool throws_early : {true, false}) {
    Started started(on_cpu());
    auto bad = started.steps[1];
    bad.front() = {1e300, 0, 0};
    if (throws_early) {
      EXPECT_THROW(started.series.step(bad), std::invalid_argument);
    } else {
      EXPECT_THROW(started.series.step(started.steps[1], true, [](double) { return false; }),
                   Cancelled);
    }

    const Counts counts = started.series.step(started.steps[1]);

    Series anew(started.sources, started.scene, on_cpu());
    anew.step(started.steps[1]);
    EXPECT_TRUE(started.series.has_bits_of(anew));
    EXPECT_EQ(counts.tets_unchanged, 0);
    EXPECT_EQ(counts.cells_unchanged, 0);
  }
}

TEST(SkipUnchangedSteps, OtherBuffersAreWrittenWhole) {
  Started started(on_cpu());
  std::vector<std::int32_t> other(started.series.owner.size(), -99);
  other.swap(started.series.owner);

  const Counts counts = started.series.step(started.steps[1]);

  EXPECT_EQ(std::ranges::count(started.series.owner, -99), 0);
  EXPECT_EQ(counts.cells_unchanged, 0);
  EXPECT_GT(counts.tets_unchanged, 0);
}

TEST(SkipUnchangedSteps, AMeshThatStaysCostsNoTest) {
  Started started(on_cpu());

  const Counts counts = started.series.step(started.steps[0]);

  EXPECT_EQ(counts.tets_unchanged, counts.tetrahedra);
  EXPECT_EQ(counts.cells_unchanged, counts.cells);
  EXPECT_EQ(counts.candidate_pairs, 0);
  EXPECT_EQ(counts.inside_tests, 0);
  EXPECT_GT(counts.covered, 0);
}

/// A quantum is 2^-20 voxel: half of it more is the same mesh, or a node that moves by one quantum.
TEST(SkipUnchangedSteps, LessThanAQuantumIsNoMotion) {
  Started started(on_cpu());
  auto near = started.steps[0], far = near;
  for (Point3& p : near) p[0] += 1e-9;
  far[20][0] += 2e-6;

  const Counts counts_near = started.series.step(near);
  const Counts counts_far = started.series.step(far);

  EXPECT_GT(counts_near.tets_unchanged, counts_near.tetrahedra / 2);
  EXPECT_LT(counts_far.tets_unchanged, counts_far.tetrahedra);
}
}  // namespace
}  // namespace tetwarp::test

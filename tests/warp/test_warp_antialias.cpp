/// @file test_warp_antialias.cpp
/// Where the source is compressed a voxel is a mean of samples, elsewhere one sample.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/affine_scenes.hpp"
#include "tests/support/skip_series.hpp"

namespace tetwarp::test {
namespace {
constexpr std::array averaging_filters = {Filter::linear, Filter::cubic, Filter::bspline,
                                          Filter::lanczos};

/// Shrunk by seven tenths and waved, on a turned grid; and by forty, which exceeds the limit of
/// samples per voxel.
std::vector<scenes::Scene> much_shrunk_scenes() {
  const Grid grid = scenes::oblique_grid(20, 17, 19);
  std::vector<scenes::Scene> scenes;
  for (const double share : {0.3, 1.0 / 40}) {
    const Eigen::Matrix3d linear = turn(0.4, {1, 2, -1}) * share;
    scenes.push_back(affine_scene(grid, grid, linear));
    scenes.back().deformed = scenes::waved(scenes.back().deformed, share, 71);
  }
  scenes.back().output_grid.dims = {9, 9, 9};
  const Point3 center = center_of(grid);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    scenes.back().output_grid.spacing[axis] = 0.1;
    scenes.back().output_grid.origin[axis] = center[axis];
  }
  scenes.front().output_grid.spacing = {1.1, 1.3, 3.9};  // voxels outside average, too
  return scenes;
}

/// float32 sums are rounded once: half an ulp of a value up to 2, and 2^-48 of its position.
TEST(WarpAntialias, IsTheReference) {
  for (const scenes::Scene& scene : much_shrunk_scenes()) {
    const Volume narrow = scenes::wavy_volume(scene.source_grid, PixelType::float32, 2);
    const Volume wide = scenes::wavy_volume(scene.source_grid, PixelType::float64);
    for (const Filter filter : averaging_filters) {
      const WarpOptions options{.filter = filter,
                                .overshoot = Overshoot::clamp,
                                .antialias = true,
                                .outside = Outside::identity,
                                .background = -3};
      const Warped expected = run_warp(wide, scene, Backend::reference, options);
      const Warped expected_narrow = run_warp(narrow, scene, Backend::reference, options);
      EXPECT_GT(expected.counts.tets_averaged, 100);
      EXPECT_GT(expected.counts.covered, 30);
      for (const Backend backend : usable_backends()) {
        SCOPED_TRACE(name_of(backend));
        const Warped warped = run_warp(wide, scene, backend, options);
        EXPECT_LE(largest_difference(warped.volume, expected.volume), 1e-11);
        EXPECT_EQ(warped.counts.tets_averaged, expected.counts.tets_averaged);
        const Warped other = run_warp(narrow, scene, backend, options);
        EXPECT_LE(largest_difference(other.volume, expected_narrow.volume), 2e-7);
      }
    }
  }
}

/// Every second voxel of a chessboard has one color: plain sampling reads only one of them.
TEST(WarpAntialias, MakesAShrunkenChessboardGray) {
  const Grid grid = scenes::unit_grid(33, 33, 33);
  Volume board = make_volume(grid, PixelType::uint8);
  for (std::size_t v = 0; v < board.data.size(); ++v) {
    board.samples<std::uint8_t>()[v] = v % 2 == 0 ? 200 : 100;
  }
  const scenes::Scene scene = affine_scene(grid, grid, 0.5 * Eigen::Matrix3d::Identity());
  for (const Backend backend : usable_backends()) {
    SCOPED_TRACE(name_of(backend));
    const Warped plain = run_warp(board, scene, backend);
    const Warped gray = run_warp(board, scene, backend, {.antialias = true});

    EXPECT_EQ(gray.counts.tets_averaged, gray.counts.tetrahedra);
    for (std::size_t v = 0; v < gray.owner.size(); ++v) {
      const std::size_t at[3] = {v % 33, v / 33 % 33, v / 33 / 33};
      const auto is_rim = [](std::size_t i) { return i < 9 || i > 23; };
      if (std::ranges::any_of(at, is_rim)) continue;
      ASSERT_EQ(gray.volume.samples<std::uint8_t>()[v], 150) << v;
      ASSERT_NE(plain.volume.samples<std::uint8_t>()[v], 150) << v;
    }
  }
}

/// Half of the nodes shrink their surroundings; the other half is stretched.
TEST(WarpAntialias, LeavesEveryBitWhereNothingIsCompressed) {
  const Grid grid = scenes::unit_grid(24, 20, 22);
  scenes::Scene scene = affine_scene(grid, grid, Eigen::Matrix3d::Identity());
  for (Point3& p : scene.deformed) p[0] = p[0] < 11.5 ? 1.2 * p[0] : 13.8 + 0.4 * (p[0] - 11.5);
  const Volume source = scenes::wavy_volume(grid, PixelType::float32);
  for (const Backend backend : usable_backends()) {
    SCOPED_TRACE(name_of(backend));
    const Warped plain = run_warp(source, scene, backend);
    const Warped mean = run_warp(source, scene, backend, {.antialias = true});

    EXPECT_GT(mean.counts.tets_averaged, 0);
    EXPECT_LT(mean.counts.tets_averaged, mean.counts.tetrahedra);
    std::int64_t equal = 0;
    for (std::size_t v = 0; v < mean.owner.size(); ++v) {
      const bool same = mean.volume.samples<float>()[v] == plain.volume.samples<float>()[v];
      equal += same;
      ASSERT_TRUE(same || v % 24 >= 9) << v;
    }
    EXPECT_LT(equal, std::ssize(mean.owner) * 9 / 10);
    EXPECT_EQ(mean.owner, plain.owner);
  }
}

/// Steps that update the one before, and leave out what they can, against steps from scratch.
TEST(WarpAntialias, HasTheSameBitsWhateverIsLeftOut) {
  const Grid grid = scenes::unit_grid(26, 24, 25);
  const scenes::Scene scene =
      affine_scene(grid, grid, turn(0.2, {0, 1, 1}) * Eigen::Vector3d(0.5, 0.9, 1.2).asDiagonal());
  const std::vector<Volume> sources = {scenes::wavy_volume(grid, PixelType::int16),
                                       scenes::wavy_volume(grid, PixelType::float32, 3)};
  for (const Backend backend : usable_backends()) {
    if (backend == Backend::reference) continue;  // leaves nothing out
    SCOPED_TRACE(name_of(backend));
    WarpOptions options{.antialias = true, .intensity = Intensity::density};
    options.quantities = {Quantity::components, Quantity::vector};
    options.backend = backend;
    Series updated(sources, scene, options);
    options.expert.skip = {false, false, false, false, false, false, false};
    options.threads = 1;
    Series anew(sources, scene, options);
    std::int64_t unchanged = 0;
    for (const auto& positions : partial_motions(scene, 83)) {
      const Counts counts = updated.step(positions), all = anew.step(positions);
      unchanged += counts.tets_unchanged;
      ASSERT_TRUE(updated.has_bits_of(anew));
      ASSERT_EQ(counts.tets_averaged, all.tets_averaged);
    }
    EXPECT_GT(unchanged, 0);
  }
}
}  // namespace
}  // namespace tetwarp::test

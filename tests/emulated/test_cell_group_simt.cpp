/// @file test_cell_group_simt.cpp
/// The kernel for four cells at a time, run by emulation, gives the bits of the host's rows.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/emulated/raster_bench.hpp"

namespace tetwarp::test {
namespace {
using scenes::Scene;

/// A block of five tetrahedra, which hold many cells each, over a grid of `size` voxels and the
/// nodes moved by `move`.
template <class Move>
Scene block_scene(std::int64_t size, const Move& move) {
  const double low = -0.5, high = static_cast<double>(size) - 0.5;
  Scene scene;
  scene.name = "block of " + std::to_string(size);
  scene.mesh = scenes::lattice({1, 1, 1}, {low, low, low}, {high, high, high});
  scene.deformed = move(scene.mesh.rest_positions);
  scene.source_grid = scene.output_grid = scenes::unit_grid(size, size - 3, size + 2);
  return scene;
}

/// Tetrahedra are stretched and sheared; the upper cells are cut by the end of the output.
Scene waved_block(std::int64_t size) {
  return block_scene(size, [](const std::vector<Point3>& x) { return scenes::waved(x, 3.0, 11); });
}

Scene shifted_block(std::int64_t size, const Point3& by) {
  return block_scene(size, [&](const std::vector<Point3>& x) { return scenes::shifted(x, by); });
}

/// @returns the number of cells that groups compute
template <class T>
std::int64_t expect_equal_bits(RasterBench<T>& bench, const RasterCase& what, int capacity = 63) {
  const Rastered<T> rows = bench.by_rows();
  simt::for_each_schedule([&](const simt::Schedule&) {
    for (const bool is_packed : {false, true}) {
      EXPECT_TRUE(is_same(bench.by_groups(capacity, is_packed), rows))
          << what.scene << ' ' << name_of(what.type) << (is_packed ? " packed" : "");
    }
  });
  return bench.cell_count() - bench.general_cells;
}

std::int64_t expect_equal_bits(const RasterCase& what) {
  std::int64_t plain = 0;
  with_pixel_type(what.type, [&]<class T>(T) {
    if constexpr (can_blend<T> && sizeof(ArithmeticOf<T>) == 4) {
      RasterBench<T> bench(what);
      plain = expect_equal_bits(bench, what);
    }
  });
  return plain;
}

TEST(CellGroupSimt, EveryPixelTypeOfFloat32ArithmeticHasTheSameBits) {
  for (const PixelType type : {PixelType::float32, PixelType::int16, PixelType::uint8,
                               PixelType::uint16, PixelType::int8}) {
    EXPECT_GT(expect_equal_bits({.type = type, .own = waved_block(44)}), 0);
  }
}

TEST(CellGroupSimt, TetrahedraOfEverySizeAndShapeHaveTheSameBits) {
  RasterCase what{.own = waved_block(52)};
  RasterBench<float> bench(what);
  EXPECT_EQ(expect_equal_bits(bench, what), bench.cell_count());
  for (const char* scene :
       {"overlapping", "waved", "aligned", "rotated", "slivers_1", "slivers_5", "soup", "folded",
        "far", "tiny", "outside", "half_voxel", "thin_aligned_1", "flat"}) {
    expect_equal_bits({.scene = scene});
  }
}

/// A grid of 26 voxels, 6^3 cubes of five tetrahedra: cells have many pairs, most of them small.
template <class Move>
Scene fine_block(const Move& move) {
  Scene scene;
  scene.name = "fine block";
  scene.mesh = scenes::lattice({6, 6, 6}, {-0.3, -0.3, -0.3}, {25.4, 25.4, 25.4});
  scene.deformed = move(scene.mesh.rest_positions);
  scene.source_grid = scene.output_grid = scenes::unit_grid(26, 25, 24);
  return scene;
}

TEST(CellGroupSimt, CellsOfManySmallTetrahedraHaveTheSameBits) {
  const RasterCase what{
      .own = fine_block([](const std::vector<Point3>& x) { return scenes::waved(x, 1.5, 3); })};
  RasterBench<float> bench(what);
  EXPECT_GT(bench.max_pairs_in_a_cell(), 30u);
  EXPECT_GT(expect_equal_bits(bench, what), 0);
}

/// Which of two tetrahedra comes first must not depend on the lanes that found them.
TEST(CellGroupSimt, SmallTetrahedraThatOverlapHaveTheSameBits) {
  for (const double fold : {7.0, 9.3, 13.0}) {
    expect_equal_bits({.own = fine_block([&](std::vector<Point3> x) {
                         for (Point3& p : x) p[0] = fold + std::abs(p[0] - fold) * 0.8;
                         return x;
                       })});
  }
}

/// A voxel may be tested against the tetrahedron that is searched beside its owner, and one that
/// waits for an exact test against all after it.
TEST(CellGroupSimt, TestsAreCountedAsInBlocksOfOneCell) {
  for (const char* scene : {"overlapping", "aligned", "waved", "slivers_1", "soup"}) {
    RasterBench<float> bench({.scene = scene});
    const RasterCounts blocks = bench.by_blocks().counts, groups = bench.by_groups().counts;
    const auto most_after = std::int64_t{bench.max_pairs_in_a_cell()} - 1;
    EXPECT_GT(blocks.inside_tests, 0) << scene;
    EXPECT_GE(groups.inside_tests, blocks.inside_tests) << scene;
    EXPECT_LE(groups.inside_tests - blocks.inside_tests,
              groups.covered + groups.exact_tests * most_after)
        << scene;
    EXPECT_LT(static_cast<double>(groups.inside_tests),
              1.02 * static_cast<double>(blocks.inside_tests))
        << scene;
  }
}

TEST(CellGroupSimt, CellsWithoutRoomForTheirPairsHaveTheSameBits) {
  const RasterCase what{.scene = "rotated"};
  RasterBench<float> bench(what);
  const std::int64_t all = expect_equal_bits(bench, what);
  const std::int64_t some = expect_equal_bits(bench, what, 7);
  EXPECT_GT(some, 0);
  EXPECT_LT(some, all);
  EXPECT_LT(expect_equal_bits(bench, what, 0), some);
}

TEST(CellGroupSimt, PositionsOnVoxelsAndBetweenThemHaveTheSameBits) {
  for (const double by : {0.0, 0.25, 0.5, -1.0 / 3}) {
    const Scene scene = shifted_block(44, {by, -by, 2 * by});
    EXPECT_GT(expect_equal_bits({.copy_whole_shifts = false, .own = scene}), 0) << by;
  }
}

TEST(CellGroupSimt, CellsMappedAcrossTheBorderOfTheSourceHaveTheSameBits) {
  for (const double by : {0.25, 9.25, -3.5, 0.5}) {
    const Scene scene = shifted_block(44, {by, -by, by / 2});
    EXPECT_GT(expect_equal_bits({.copy_whole_shifts = false, .own = scene}), 0);
  }
}

TEST(CellGroupSimt, CellsThatAreKeptOrFilledHaveTheSameBits) {
  const RasterCase what{.own = waved_block(52)};
  RasterBench<float> bench(what);
  const std::int64_t all = expect_equal_bits(bench, what);
  bench.mix_work();
  const std::int64_t some = expect_equal_bits(bench, what);
  EXPECT_GT(some, 0);
  EXPECT_LT(some, all);
}

TEST(CellGroupSimt, VoxelsOutsideTheMeshHaveTheSameBits) {
  OutsideMap identity{true, true, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0, 0}};
  expect_equal_bits({.outside = identity, .own = waved_block(52)});
}

TEST(CellGroupSimt, RegionsThatCutCellsHaveTheSameBits) {
  for (const Region& region : {Region{{3, 5, 1}, {45, 39, 40}}, Region{{9, 8, 16}, {40, 40, 41}}}) {
    EXPECT_GT(expect_equal_bits({.region = region, .own = waved_block(48)}), 0);
  }
}

TEST(CellGroupSimt, SmallOutputsHaveTheSameBits) {
  for (const std::int64_t size : {5, 8, 12}) {
    EXPECT_GT(expect_equal_bits({.own = waved_block(size)}), 0);
  }
}

TEST(CellGroupSimt, OtherJobsHaveNoPlainCells) {
  RasterJob<float> job{};
  job.source.components = 1;
  job.filter = Filter::linear;
  job.source.dims[0] = job.source.dims[1] = job.source.dims[2] = 100;
  EXPECT_TRUE(has_plain_cells(job));
  job.filter = Filter::nearest;
  EXPECT_FALSE(has_plain_cells(job));
  job.filter = Filter::linear;
  job.source.components = 2;
  EXPECT_FALSE(has_plain_cells(job));
  job.source.components = 1;
  job.source.dims[2] = 1;
  EXPECT_FALSE(has_plain_cells(job));
  job.source.dims[2] = 100;
  job.source.dims[0] = job.source.dims[1] = 4000;  // offsets within a cell exceed 31 bits
  EXPECT_FALSE(has_plain_cells(job));
  EXPECT_FALSE(has_plain_cells(RasterJob<double>{}));
}

TEST(CellGroupSimt, FloorAndOffsetAreExactWithinReach) {
  for (const float x : {-84.25f, -3.0f, -1.0f, -0x1p-20f, -0.0f, 0.0f, 0x1p-30f, 0.5f, 0.99999994f,
                        1.0f, 41.75f, 86.0f}) {
    float lower = 99;
    const std::uint32_t bits = floor_bits(x, lower);
    EXPECT_EQ(lower, std::floor(x));
    EXPECT_EQ(static_cast<std::int32_t>(bits - integer_bits), static_cast<int>(std::floor(x)));
  }
}

/// Offsets of a cell in a source of wide slices reach far beyond 16 million samples.
TEST(CellGroupSimt, OffsetsInWideSlicesAreExact) {
  const int dims[3] = {1 << 12, 1 << 11, 64};
  const std::vector<std::uint8_t> nothing(1);
  const InteriorSource<std::uint8_t> source(nothing.data(), dims, 77);
  for (const int k : {-80, -1, 0, 5, 84}) {
    for (const int j : {-80, 0, 84}) {
      const float x[3] = {-7.5f, static_cast<float>(j) + 0.25f, static_cast<float>(k) + 0.75f};
      const std::int64_t offset = source.offset_of(interior_tap(x)) + 77;
      EXPECT_EQ(offset, (std::int64_t{k} * dims[1] + j) * dims[0] - 8);
    }
  }
}
}  // namespace
}  // namespace tetwarp::test

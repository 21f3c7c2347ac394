/// @file test_cell_interior_simt.cpp
/// The kernels for cells within one tetrahedron, run by emulation, give the bits of the host's
/// rows, beside cells of every other class.
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

/// @returns the number of interior cells
template <class T>
int expect_equal_bits(RasterBench<T>& bench, const RasterCase& what) {
  const Rastered<T> rows = bench.by_rows();
  simt::for_each_schedule([&](const simt::Schedule&) {
    EXPECT_TRUE(is_same(bench.by_classes(), rows)) << what.scene << ' ' << name_of(what.type);
  });
  return bench.interior_cells;
}

int expect_equal_bits(const RasterCase& what) {
  int interior = 0;
  with_pixel_type(what.type, [&]<class T>(T) {
    if constexpr (can_blend<T> && sizeof(ArithmeticOf<T>) == 4) {
      RasterBench<T> bench(what);
      interior = expect_equal_bits(bench, what);
    }
  });
  return interior;
}

TEST(CellInteriorSimt, EveryPixelTypeOfFloat32ArithmeticHasTheSameBits) {
  for (const PixelType type : {PixelType::float32, PixelType::int16, PixelType::uint8,
                               PixelType::uint16, PixelType::int8}) {
    EXPECT_GT(expect_equal_bits({.type = type, .own = waved_block(44)}), 0);
  }
}

TEST(CellInteriorSimt, InteriorCellsBesideCellsOfEveryOtherClassHaveTheSameBits) {
  RasterCase what{.own = waved_block(52)};
  RasterBench<float> bench(what);
  EXPECT_GT(expect_equal_bits(bench, what), 10);
  EXPECT_GT(bench.tested_cells, 10);
  EXPECT_GT(bench.general_cells, 10);
  // Tetrahedra that overlap: the lowest accepts, or a lower one claims some of the voxels.
  expect_equal_bits({.scene = "overlapping"});
  for (const char* scene : {"waved", "aligned", "rotated", "slivers_1", "soup", "folded", "far"}) {
    EXPECT_EQ(expect_equal_bits({.scene = scene}), 0) << scene;  // their tetrahedra are small
  }
}

TEST(CellInteriorSimt, TestsAreCountedAsInBlocksOfOneCell) {
  for (const char* scene : {"overlapping", "aligned", "waved", "slivers_1", "soup"}) {
    RasterBench<float> bench({.scene = scene});
    const RasterCounts blocks = bench.by_blocks().counts, classes = bench.by_classes().counts;
    EXPECT_GT(blocks.inside_tests, 0) << scene;
    EXPECT_EQ(classes.inside_tests, blocks.inside_tests) << scene;
    EXPECT_EQ(classes.exact_tests, blocks.exact_tests) << scene;
  }
}

TEST(CellInteriorSimt, PositionsOnVoxelsAndBetweenThemHaveTheSameBits) {
  for (const double by : {0.0, 0.25, 0.5, -1.0 / 3}) {
    const Scene scene = shifted_block(44, {by, -by, 2 * by});
    EXPECT_GT(expect_equal_bits({.copy_whole_shifts = false, .own = scene}), 0) << by;
  }
  EXPECT_EQ(expect_equal_bits({.own = shifted_block(44, {1, 0, 0})}), 0);  // copied
}

TEST(CellInteriorSimt, CellsMappedAcrossTheBorderOfTheSourceAreNotInterior) {
  const Scene inside = shifted_block(44, {0.25, 0, 0}), across = shifted_block(44, {9.25, 0, 0});
  EXPECT_LT(expect_equal_bits({.own = across}), expect_equal_bits({.own = inside}));
}

TEST(CellInteriorSimt, CellsThatAreKeptOrFilledHaveTheSameBits) {
  const RasterCase what{.own = waved_block(52)};
  RasterBench<float> bench(what);
  const int all = expect_equal_bits(bench, what);
  bench.mix_work();
  const int some = expect_equal_bits(bench, what);
  EXPECT_GT(some, 0);
  EXPECT_LT(some, all);
}

TEST(CellInteriorSimt, RegionsThatCutCellsHaveTheSameBits) {
  for (const Region& region : {Region{{3, 5, 1}, {45, 39, 40}}, Region{{9, 8, 16}, {40, 40, 41}}}) {
    EXPECT_GT(expect_equal_bits({.region = region, .own = waved_block(48)}), 0);
  }
}

TEST(CellInteriorSimt, SmallOutputsHaveNoInteriorCell) {
  for (const std::int64_t size : {5, 8, 12}) {
    EXPECT_EQ(expect_equal_bits({.own = waved_block(size)}), 0);
  }
}

TEST(CellInteriorSimt, OtherJobsHaveNoInteriorCells) {
  RasterJob<float> job{};
  job.source.components = 1;
  job.filter = Filter::linear;
  job.source.dims[0] = job.source.dims[1] = job.source.dims[2] = 100;
  EXPECT_TRUE(has_interior_cells(job));
  job.filter = Filter::nearest;
  EXPECT_FALSE(has_interior_cells(job));
  job.filter = Filter::linear;
  job.source.components = 2;
  EXPECT_FALSE(has_interior_cells(job));
  job.source.components = 1;
  job.source.dims[0] = job.source.dims[1] = 4000;  // offsets within a cell exceed 31 bits
  EXPECT_FALSE(has_interior_cells(job));
  EXPECT_FALSE(has_interior_cells(RasterJob<double>{}));
}

TEST(CellInteriorSimt, FloorAndOffsetAreExactWithinReach) {
  for (const float x : {-84.25f, -3.0f, -1.0f, -0x1p-20f, -0.0f, 0.0f, 0x1p-30f, 0.5f, 0.99999994f,
                        1.0f, 41.75f, 86.0f}) {
    float lower = 99;
    const std::uint32_t bits = floor_bits(x, lower);
    EXPECT_EQ(lower, std::floor(x));
    EXPECT_EQ(static_cast<std::int32_t>(bits - integer_bits), static_cast<int>(std::floor(x)));
  }
}

/// Offsets of a cell in a source of wide slices reach far beyond 16 million samples.
TEST(CellInteriorSimt, OffsetsInWideSlicesAreExact) {
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

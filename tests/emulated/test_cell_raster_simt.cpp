/// @file test_cell_raster_simt.cpp
/// The hand-mapped raster kernel, run by emulation in several thread orders, gives the bits of the
/// row-by-row raster of the host. A separate program, because the emulation defines CUDA's names.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include "tests/emulated/raster_bench.hpp"

namespace tetwarp::test {
namespace {
void expect_bits_of_rows(const RasterCase& what) {
  with_pixel_type(what.type, [&]<class T>(T) {
    RasterBench<T> bench(what);
    const Rastered<T> rows = bench.by_rows();
    EXPECT_GT(rows.counts.covered, 0) << what.scene;
    simt::for_each_schedule([&](const simt::Schedule&) {
      EXPECT_TRUE(is_same(bench.by_blocks(), rows)) << what.scene << ' ' << name_of(what.type);
    });
  });
}

/// Half as fast along x, somewhat shifted: uncovered voxels are interpolated.
OutsideMap stretched() {
  return {true, false, {{0.5, 0, 0.01}, {0, 1, 0}, {0.02, 0, 0.9}}, {0.3, -0.2, 1.7}};
}

OutsideMap same_place(double i, double j, double k) {
  return {true, true, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {i, j, k}};
}

TEST(CellRasterSimt, EveryPixelTypeHasTheSameBits) {
  for (const PixelType type :
       {PixelType::float32, PixelType::int16, PixelType::uint8, PixelType::uint16, PixelType::int8,
        PixelType::float64, PixelType::int32}) {
    expect_bits_of_rows({.type = type});
  }
  for (const PixelType type : {PixelType::uint64, PixelType::int16, PixelType::float32}) {
    expect_bits_of_rows({.type = type, .filter = Filter::nearest});
  }
}

TEST(CellRasterSimt, EveryFilterHasTheSameBits) {
  for (const Filter filter : {Filter::cubic, Filter::bspline, Filter::lanczos}) {
    for (const char* scene : {"waved", "other_grid"}) {
      for (const PixelType type : {PixelType::float32, PixelType::uint8, PixelType::int16}) {
        expect_bits_of_rows(
            {.scene = scene, .type = type, .filter = filter, .outside = stretched()});
      }
    }
    expect_bits_of_rows({.type = PixelType::float32, .components = 3, .filter = filter});
    expect_bits_of_rows({.type = PixelType::float64, .filter = filter});
  }
  for (const PixelType type : {PixelType::uint8, PixelType::int16, PixelType::uint64}) {
    expect_bits_of_rows({.type = type, .filter = Filter::labels, .outside = stretched()});
  }
}

TEST(CellRasterSimt, EverySceneHasTheSameBits) {
  for (const char* scene :
       {"identity", "aligned", "rotated", "outside", "oblique", "slivers_1", "thin_aligned_1",
        "soup", "overlapping", "folded", "far", "other_grid"}) {
    expect_bits_of_rows({.scene = scene, .type = PixelType::int16});
    expect_bits_of_rows({.scene = scene, .type = PixelType::float32});
  }
}

TEST(CellRasterSimt, SeveralComponentsHaveTheSameBits) {
  for (const int components : {2, 3, 9}) {
    expect_bits_of_rows({.type = PixelType::uint8, .components = components});
    expect_bits_of_rows({.type = PixelType::float32, .components = components});
    expect_bits_of_rows({.type = PixelType::float64, .components = components});
  }
}

TEST(CellRasterSimt, CopyingAndInterpolatingHaveTheSameBits) {
  expect_bits_of_rows({.scene = "aligned", .copy_whole_shifts = false});
  const Rastered<float> copied = RasterBench<float>({.scene = "aligned"}).by_blocks();
  const Rastered<float> blended =
      RasterBench<float>({.scene = "aligned", .copy_whole_shifts = false}).by_blocks();
  EXPECT_EQ(copied.volume, blended.volume);
  EXPECT_EQ(copied.counts.copied, copied.counts.covered);
  EXPECT_EQ(blended.counts.copied, 0);
}

TEST(CellRasterSimt, UncoveredVoxelsHaveTheSameBits) {
  for (const PixelType type : {PixelType::float32, PixelType::uint8, PixelType::float64}) {
    expect_bits_of_rows({.scene = "rotated", .type = type, .outside = same_place(0, 0, 0)});
    expect_bits_of_rows({.scene = "rotated", .type = type, .outside = stretched()});
  }
}

TEST(CellRasterSimt, WindowsThatStartInsideACellHaveTheSameBits) {
  for (const Region& region : {Region{{3, 5, 1}, {20, 16, 19}}, Region{{9, 0, 7}, {10, 17, 8}},
                               Region{{15, 15, 15}, {20, 17, 22}}}) {
    for (const char* scene : {"identity", "waved"}) {
      expect_bits_of_rows({.scene = scene, .region = region});
      expect_bits_of_rows(
          {.scene = scene, .type = PixelType::int16, .outside = stretched(), .region = region});
    }
  }
}

/// A block takes 16 tetrahedra at a time; "tiny" has hundreds in a cell.
TEST(CellRasterSimt, CellsOfManyTetrahedraHaveTheSameBits) {
  EXPECT_GT(RasterBench<float>({.scene = "tiny"}).max_pairs_in_a_cell(), 10u * raster_chunk);
  EXPECT_GT(RasterBench<float>({.scene = "soup"}).max_pairs_in_a_cell(), raster_chunk + 0u);
  expect_bits_of_rows({.scene = "tiny"});
  expect_bits_of_rows({.scene = "tiny", .type = PixelType::int16});
}

/// Kept cells are not written, filled ones hold their voxel's samples where they are covered.
template <class T>
void expect_equal_work(const RasterCase& what) {
  RasterBench<T> bench(what);
  const Rastered<T> all = bench.by_rows();
  bench.mix_work();
  const Rastered<T> rows = bench.by_rows();
  simt::for_each_schedule([&](const simt::Schedule&) {
    EXPECT_TRUE(is_same(bench.by_blocks(), rows)) << what.scene << ' ' << name_of(what.type);
  });
  std::size_t kept = 0;
  for (std::size_t v = 0; v < rows.owner.size(); ++v) {
    if (rows.owner[v] == -99) ++kept;
    EXPECT_EQ(rows.owner[v] == -99, rows.mask[v] == 0xee);
    EXPECT_TRUE(rows.owner[v] == -99 || rows.owner[v] == all.owner[v]);
  }
  EXPECT_GT(kept, rows.owner.size() / 8);
  EXPECT_LT(kept, rows.owner.size());
  EXPECT_LT(rows.counts.covered, all.counts.covered);
  EXPECT_NE(rows.volume, all.volume);
}

TEST(CellRasterSimt, CellsThatAreKeptOrFilledHaveTheSameBits) {
  expect_equal_work<float>({});
  expect_equal_work<float>({.components = 3, .filter = Filter::nearest});
  expect_equal_work<std::int16_t>({.scene = "soup", .type = PixelType::int16});
  expect_equal_work<double>({.scene = "rotated",
                             .type = PixelType::float64,
                             .outside = stretched(),
                             .region = Region{{3, 5, 1}, {20, 16, 19}}});
}

TEST(CellRasterSimt, CoveredVoxelsAreCountedPerCell) {
  const Rastered<float> blocks = RasterBench<float>({.scene = "waved"}).by_blocks();

  std::int64_t sum = 0;
  for (const std::uint16_t covered : blocks.cell_covered) sum += covered;
  EXPECT_EQ(sum, blocks.counts.covered);
  EXPECT_GT(sum, 0);
}

TEST(CellRasterSimt, EveryVoxelIsWritten) {
  const Rastered<float> blocks = RasterBench<float>({.scene = "waved"}).by_blocks();

  EXPECT_EQ(std::ranges::count(blocks.volume, 55.0f), 0);
  EXPECT_EQ(std::ranges::count(blocks.owner, -99), 0);
  EXPECT_EQ(std::ranges::count(blocks.mask, 0xee), 0);
}
}  // namespace
}  // namespace tetwarp::test

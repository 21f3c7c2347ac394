/// @file test_cli_memory.cpp
/// --memory and --dry-run: volumes larger than memory, in blocks.
#include <gtest/gtest.h>
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/cli_scene.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;
using Json = nlohmann::json;

constexpr double mebibyte = 1 << 20;

/// Writes nx x ny x nz samples of `components` components slab by slab, to use little memory.
void write_large_volume(const std::string& path, const Grid& grid, PixelType type, int components) {
  const ArrayHeader header{"density", type, components};
  BlockVolumeWriter writer(path, grid, {header}, {}, false);
  const std::int64_t depth = block_step(grid, {header})[2];
  for (std::int64_t k = 0; k < grid.dims[2]; k += depth) {
    Grid slab = grid;
    slab.dims[2] = std::min(depth, grid.dims[2] - k);
    slab.origin[2] = static_cast<double>(k);
    const Volume part = scenes::wavy_volume(slab, type, components);
    writer.write(0, {{0, 0, k}, {grid.dims[0], grid.dims[1], k + slab.dims[2]}}, part.data.data());
  }
  writer.finish();
}

/// A mesh around a grid of unit spacing, at rest and in two steps of waves.
void write_waves(const std::string& path, const Grid& grid) {
  Point3 high;
  for (std::size_t axis = 0; axis < 3; ++axis) high[axis] = double(grid.dims[axis]) - 0.5;
  const Mesh mesh = scenes::lattice({6, 6, 4}, {-0.5, -0.5, -0.5}, high);
  std::vector<std::vector<Point3>> steps;
  for (const std::uint64_t seed : {3, 4}) {
    std::vector<Point3> moved = scenes::waved(mesh.rest_positions, 5, seed);
    for (std::size_t n = 0; n < moved.size(); ++n) {
      for (std::size_t axis = 0; axis < 3; ++axis) moved[n][axis] -= mesh.rest_positions[n][axis];
    }
    steps.push_back(moved);
  }
  steps.push_back(steps.back());
  write_mesh(path, mesh, steps, {0, 1, 2});
}

/// Whether two files hold the same arrays, read slice by slice.
testing::AssertionResult holds_same(const std::string& a,
                                    const std::string& b,
                                    std::int64_t step = 0) {
  const VolumeHeader header = read_volume_header(a);
  const VolumeHeader other = read_volume_header(b);
  if (header.arrays != other.arrays || header.grid != other.grid || header.times != other.times) {
    return testing::AssertionFailure() << "other headers";
  }
  const auto& n = header.grid.dims;
  for (const ArrayHeader& array : header.arrays) {
    const VolumeReader first(a, array.name, step), second(b, array.name, step);
    const auto bytes =
        static_cast<std::size_t>(n[0] * n[1] * array.components) * size_of(array.type);
    std::vector<std::byte> mine(bytes), theirs(bytes);
    for (std::int64_t k = 0; k < n[2]; ++k) {
      first.read({{0, 0, k}, {n[0], n[1], k + 1}}, mine.data());
      second.read({{0, 0, k}, {n[0], n[1], k + 1}}, theirs.data());
      if (mine != theirs) return testing::AssertionFailure() << array.name << ", slice " << k;
    }
  }
  return testing::AssertionSuccess();
}

/// Two arrays of 200 x 160 x 110 voxels, 21 MB, and a mesh of three steps of which the last two are
/// equal.
class MemoryLimit : public testing::Test {
 protected:
  MemoryLimit() {
    const Grid grid = scenes::unit_grid(200, 160, 110);
    Volume density = scenes::wavy_volume(grid, PixelType::float32);
    Volume labels = scenes::wavy_volume(grid, PixelType::int16);
    density.name = "density";
    labels.name = "labels";
    write_volumes(folder / "volume.vtkhdf", {&density, &labels});
    write_waves(folder / "mesh.vtkhdf", grid);
  }

  /// Runs with and without a limit, expects the same arrays, and returns the report of the first.
  Json expect_same(const Names& outputs, Names words) const {
    words.insert(words.begin(), {"warp", "volume.vtkhdf", "mesh.vtkhdf", "--outputs", "mask,tet"});
    Names limited = words;
    limited.insert(limited.end(), {"--memory", limit, "--report", "report.json", "-o", "a.vtkhdf"});
    words.insert(words.end(), {"-o", "b.vtkhdf"});
    for (const Names& run : {limited, words}) {
      const CommandResult result = run_command(folder, run);
      EXPECT_EQ(result.exit_code, 0) << result.err;
    }
    for (const std::string& output : outputs) {
      const std::int64_t last =
          std::max<std::int64_t>(1, std::ssize(read_volume_header(folder / ("a" + output)).times));
      for (std::int64_t step = 0; step < last; ++step) {
        EXPECT_TRUE(holds_same(folder / ("a" + output), folder / ("b" + output), step)) << output;
      }
    }
    return Json::parse(text_of(folder / "report.json"));
  }

  /// Source and outputs together take as much, the process without them half of it.
  const std::string limit = "60M";
  TemporaryFolder folder;
};

TEST_F(MemoryLimit, GivesTheSameArraysInBlocks) {
  const Json report = expect_same({"_0000.vtkhdf", "_0001.vtkhdf", "_0002.vtkhdf"}, {});

  const Json& counts = report["counts"];
  EXPECT_GT(counts["blocks"], 6);
  EXPECT_EQ(counts["voxels"], 3 * 200 * 160 * 110);
  EXPECT_EQ(counts["covered"].get<std::int64_t>() + counts["outside"].get<std::int64_t>(),
            counts["voxels"]);
  EXPECT_EQ(counts["tetrahedra"], 3 * 6 * 6 * 4 * 5);
  EXPECT_GT(report["timings"]["write"], 0);
}

TEST_F(MemoryLimit, ServesRegionsFiltersCompressionAndOneFileOfAllSteps) {
  const Json report = expect_same(
      {".vtkhdf"}, {"--temporal", "--steps", "1:3", "--roi", "3:190,10:151,5:107", "--filter",
                    "cubic", "--overshoot", "clamp", "--outside", "identity", "--compress", "1"});

  EXPECT_EQ(report["counts"]["steps_unchanged"], 1);
  EXPECT_GT(report["counts"]["blocks"], 4);
}

TEST_F(MemoryLimit, ResumesWhatARunWithoutItHasWritten) {
  expect_same({"_0000.vtkhdf"}, {});
  fs::remove(folder / "b_0001.vtkhdf");

  const CommandResult result =
      run_command(folder, {"warp", "volume.vtkhdf", "mesh.vtkhdf", "--outputs", "mask,tet",
                           "--memory", limit, "--resume", "-o", "b.vtkhdf"});

  EXPECT_NE(result.out.find("1 written, 2 skipped"), std::string::npos) << result.out << result.err;
  EXPECT_TRUE(holds_same(folder / "a_0001.vtkhdf", folder / "b_0001.vtkhdf"));
}

TEST_F(MemoryLimit, FailsWithOneLineWhenTooLow) {
  const auto expect_error = [&](const Names& more, int exit_code, const std::string& part) {
    Names words{"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o", "out.vtkhdf"};
    words.insert(words.end(), more.begin(), more.end());
    const CommandResult result = run_command(folder, words);
    EXPECT_EQ(result.exit_code, exit_code) << part;
    EXPECT_TRUE(result.has_one_line_error()) << result.err;
    EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
  };
  expect_error({"--memory", "1M"}, 1, "give at least");
  expect_error({"--memory", "32M", "--filter", "bspline"}, 1, "--filter cubic");
  for (const char* size : {"0", "-4G", "4X", "G", "4GB", "nan", "inf", ""}) {
    expect_error({std::string("--memory=") + size}, 2, "--memory");
  }
  EXPECT_EQ(folder.names(), (Names{"mesh.vtkhdf", "volume.vtkhdf"}));
}

TEST(LargeVolume, FourTimesTheLimitKeepsToIt) {
  const TemporaryFolder folder;
  const Grid grid = scenes::unit_grid(512, 512, 256);
  constexpr double limit = 64 * mebibyte;
  ASSERT_GE(static_cast<double>(grid.voxel_count()) * sizeof(float), 4 * limit);
  write_large_volume(folder / "volume.vtkhdf", grid, PixelType::float32, 1);
  write_waves(folder / "mesh.vtkhdf", grid);

  const CommandResult limited =
      run_command(folder, {"warp", "volume.vtkhdf", "mesh.vtkhdf", "--steps", "0", "--memory",
                           "64M", "-o", "blocks.vtkhdf"});
  const CommandResult whole = run_command(
      folder, {"warp", "volume.vtkhdf", "mesh.vtkhdf", "--steps", "0", "-o", "whole.vtkhdf"});

  EXPECT_EQ(limited.exit_code, 0) << limited.err;
  EXPECT_EQ(whole.exit_code, 0) << whole.err;
  EXPECT_LE(limited.peak_memory, 1.1 * limit);
  EXPECT_GT(whole.peak_memory, 7 * limit);
  RecordProperty("peak_MiB", static_cast<int>(limited.peak_memory / mebibyte));
  EXPECT_TRUE(holds_same(folder / "blocks.vtkhdf", folder / "whole.vtkhdf"));
}

/// A file of 2048^3 samples that are all background: no chunk is stored.
void write_header_only(const std::string& path,
                       std::int64_t edge,
                       PixelType type = PixelType::float32) {
  Grid grid = scenes::unit_grid(edge, edge, edge);
  BlockVolumeWriter(path, grid, {{"density", type, 1}}, {}, false).finish();
}

TEST(DryRun, PlansBillionsOfVoxelsFromHeadersAlone) {
  const TemporaryFolder folder;
  write_header_only(folder / "volume.vtkhdf", 2048);
  write_waves(folder / "mesh.vtkhdf", scenes::unit_grid(2048, 2048, 2048));
  const Names words{"warp", "volume.vtkhdf", "mesh.vtkhdf", "--steps",  "0",
                    "-o",   "out",           "--dry-run",   "--report", "plan.json"};
  const auto plan = [&](const Names& more, bool needs_much) {
    Names all = words;
    all[6] = "out.vtkhdf";
    all.insert(all.end(), more.begin(), more.end());
    const CommandResult result = run_command(folder, all);
    const bool may_be_refused = needs_much && result.err.find("are available") != std::string::npos;
    EXPECT_EQ(result.exit_code, may_be_refused ? 1 : 0) << result.err;
    EXPECT_LT(result.peak_memory, 100 * mebibyte);
    EXPECT_NE(result.out.find("2048 x 2048 x 2048 voxels"), std::string::npos) << result.out;
    return Json::parse(text_of(folder / "plan.json"));
  };
  constexpr double voxels = 2048.0 * 2048 * 2048;

  const Json at_once = plan({}, true);
  EXPECT_GT(at_once["plans"][0]["memory"].get<double>(), 8 * voxels);
  EXPECT_LT(at_once["plans"][0]["memory"].get<double>(), 1.06 * 8 * voxels);  // with lists of cells
  EXPECT_EQ(at_once["plans"][0]["blocks"], 0);

  const Json streamed = plan({"--memory", "2G"}, false);
  const Json& step = streamed["plans"][0];
  EXPECT_EQ(streamed["status"], "planned");
  EXPECT_LE(step["memory"].get<double>(), 2048 * mebibyte);
  EXPECT_GT(step["memory"].get<double>(), 700 * mebibyte);
  EXPECT_GE(step["blocks"].get<double>() * step["largest_block"].get<double>(), voxels);
  EXPECT_GT(step["bytes_read"].get<double>(), 3.5 * voxels);
  EXPECT_LT(step["bytes_read"].get<double>(), 8 * voxels);
  EXPECT_EQ(folder.names(), (Names{"mesh.vtkhdf", "plan.json", "volume.vtkhdf"}));
}

/// Labels by Gaussian weights need the tetrahedron of each voxel.
TEST(DryRun, CountsOwnersOfGaussianLabels) {
  const TemporaryFolder folder;
  constexpr std::int64_t edge = 256;
  write_header_only(folder / "volume.vtkhdf", edge, PixelType::uint8);
  write_waves(folder / "mesh.vtkhdf", scenes::unit_grid(edge, edge, edge));
  const auto planned = [&](const Names& more) {
    Names words{"warp",     "volume.vtkhdf", "mesh.vtkhdf",  "--steps",  "0",
                "-o",       "o.vtkhdf",      "--dry-run",    "--report", "plan.json",
                "--filter", "labels",        "--label-rule", "gaussian"};
    words.insert(words.end(), more.begin(), more.end());
    EXPECT_EQ(run_command(folder, words).exit_code, 0);
    return Json::parse(text_of(folder / "plan.json"))["plans"][0]["memory"].get<double>();
  };
  constexpr double voxels = static_cast<double>(edge * edge * edge);

  // The output `tet` holds the same numbers: it takes their place.
  const double kept = planned({});
  EXPECT_GT(kept, 6 * voxels);
  EXPECT_NEAR(kept, planned({"--outputs", "tet"}), 0.5 * voxels);
}
}  // namespace
}  // namespace tetwarp::test

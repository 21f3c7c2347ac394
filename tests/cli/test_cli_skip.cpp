/// @file test_cli_skip.cpp
/// Skipped work: its counts in the report, and outputs that do not depend on it.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include <tetwarp/io.hpp>

#include "tests/support/run_command.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {
namespace {
using Json = nlohmann::json;

/// A folder with volume.vtkhdf, 48 voxels per axis, one array half and one all air, and mesh.vtkhdf
/// with six steps: first a corner of the mesh bulges, then nothing moves, then a node beyond the
/// volume's end moves.
class PartlyMoving : public TemporaryFolder {
 public:
  PartlyMoving() {
    const Grid grid = scenes::unit_grid(48, 48, 48);
    Volume volume = scenes::wavy_volume(grid, PixelType::int16);
    volume.name = "density";
    const auto samples = volume.samples<std::int16_t>();
    std::fill(samples.begin() + 48 * 48 * 20, samples.end(), std::int16_t{0});
    const Volume air = make_volume(grid, PixelType::uint8, 1, "air");
    write_volumes(*this / "volume.vtkhdf", {&air, &volume});
    const Mesh mesh = scenes::lattice({6, 6, 6}, {-0.5, -0.5, -0.5}, {87.5, 47.5, 47.5});
    std::vector<std::vector<Point3>> steps;
    std::vector<Point3> displacement(mesh.rest_positions.size(), Point3{0, 0, 0});
    steps.push_back(displacement);
    for (const double bulge : {1.0, 2.0, 2.0}) {
      for (std::size_t n = 0; n < displacement.size(); ++n) {
        const Point3& p = mesh.rest_positions[n];
        if (p[0] < 20 && p[1] < 20 && p[2] < 20) displacement[n] = {bulge, 0.5 * bulge, -bulge};
      }
      steps.push_back(displacement);
    }
    for (const double further : {1.0, 2.0}) {
      displacement.back() = {further, 0, 0};
      steps.push_back(displacement);
    }
    write_mesh(*this / "mesh.vtkhdf", mesh, steps, {0, 1, 2, 3, 4, 5});
  }

  /// Runs the warp into `out` and returns the report.
  Json warp(const std::string& out, const std::vector<std::string>& more) const {
    std::vector<std::string> words = {
        "warp", "volume.vtkhdf", "mesh.vtkhdf", "--backend", "cpu",     "-o",
        out,    "--report",      "report.json", "--outputs", "mask,tet"};
    words.insert(words.end(), more.begin(), more.end());
    const CommandResult result = run_command(*this, words);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(text_of(*this / "report.json"));
  }

  void expect_same(const std::string& a, const std::string& b, std::int64_t step = 0) const {
    for (const ArrayHeader& header : read_volume_header(*this / a).arrays) {
      const std::string& name = header.name;
      EXPECT_EQ(read_volume(*this / a, name, step).data, read_volume(*this / b, name, step).data)
          << a << ' ' << name << ' ' << step;
    }
  }
};

TEST(CliSkip, EachSwitchGivesTheSameFilesAndStopsItsCount) {
  const PartlyMoving scene;
  const std::vector<std::string> fields = {"--outputs", "displacement,jacobian,forward"};
  const Json fast = scene.warp("fast.vtkhdf", fields)["counts"];
  const std::vector<std::pair<std::string, std::vector<std::string>>> switches = {
      {"unchanged-tets", {"tets_unchanged", "cells_unchanged"}},
      {"constant-cells", {"cells_constant"}},
      {"unchanged-steps", {"steps_unchanged"}},
      {"background-chunks", {"chunks_background"}},
      {"copied-voxels", {"voxels_copied"}}};
  for (const auto& [name, counts] : switches) {
    std::vector<std::string> words = fields;
    words.insert(words.end(), {"--no-skip", name});
    const Json slow = scene.warp("slow.vtkhdf", words)["counts"];

    for (const std::string& count : counts) {
      EXPECT_GT(fast[count], 0) << count;
      EXPECT_EQ(slow[count], 0) << count;
    }
    for (int step = 0; step < 6; ++step) {
      const std::string suffix = "_000" + std::to_string(step) + ".vtkhdf";
      scene.expect_same("fast" + suffix, "slow" + suffix);
    }
    for (const char* same : {"voxels", "covered", "outside", "tetrahedra", "inverted", "flat"}) {
      EXPECT_EQ(fast[same], slow[same]) << same;
    }
  }
}

TEST(CliSkip, GridPointMasksGiveTheSameFilesAndHaveATime) {
  const PartlyMoving scene;
  const Json fast = scene.warp("fast.vtkhdf", {});

  const Json slow = scene.warp("slow.vtkhdf", {"--no-skip", "grid-point-masks"});

  EXPECT_EQ(fast["timings"]["mask"], 0);
  EXPECT_GT(slow["timings"]["mask"], 0);
  EXPECT_EQ(fast["counts"]["candidate_pairs"], slow["counts"]["candidate_pairs"]);
  for (int step = 0; step < 6; ++step) {
    const std::string suffix = "_000" + std::to_string(step) + ".vtkhdf";
    scene.expect_same("fast" + suffix, "slow" + suffix);
  }
}

TEST(CliSkip, ReportsPerStepWhatStayed) {
  const PartlyMoving scene;

  const Json steps = scene.warp("out.vtkhdf", {})["steps"];

  EXPECT_EQ(steps[0]["counts"]["tets_unchanged"], 0);
  EXPECT_GT(steps[1]["counts"]["tets_unchanged"], 1080 / 2);
  EXPECT_GT(steps[1]["counts"]["cells_unchanged"], 216 / 2);
  EXPECT_EQ(steps[3]["counts"]["steps_unchanged"], 1);
  EXPECT_EQ(steps[4]["counts"]["cells_unchanged"], 216);
  EXPECT_LT(steps[4]["counts"]["tets_unchanged"], 1080);
}

/// With compression each step is written while the next one is computed.
TEST(CliSkip, StepsWrittenBesideTheNextAreTheSame) {
  const PartlyMoving scene;

  const Json beside = scene.warp("beside.vtkhdf", {"--compress", "1"})["counts"];
  const Json after = scene.warp("after.vtkhdf", {})["counts"];

  for (int step = 0; step < 6; ++step) {
    const std::string suffix = "_000" + std::to_string(step) + ".vtkhdf";
    scene.expect_same("beside" + suffix, "after" + suffix);
  }
  for (const char* same : {"voxels", "covered", "tets_unchanged"}) {
    EXPECT_EQ(beside[same], after[same]) << same;
  }
  // The second of the two outputs is empty when it is first written.
  EXPECT_GT(beside["cells_unchanged"], 0);
  EXPECT_LT(beside["cells_unchanged"], after["cells_unchanged"]);
}

/// Steps 3, 4 and 5 equal step 2: their offset is repeated.
TEST(CliSkip, StoresTemporalStepsThatLookTheSameOnce) {
  const PartlyMoving scene;

  scene.warp("fast.vtkhdf", {"--temporal"});
  scene.warp("slow.vtkhdf", {"--temporal", "--no-skip", "unchanged-steps,unchanged-tets"});

  for (int step = 0; step < 6; ++step) scene.expect_same("fast.vtkhdf", "slow.vtkhdf", step);
  const auto samples = 48 * 48 * 48 * (sizeof(std::int16_t) + 1 + sizeof(std::int32_t));
  EXPECT_EQ(std::filesystem::file_size(scene / "fast.vtkhdf") / samples, 3u);
  EXPECT_EQ(std::filesystem::file_size(scene / "slow.vtkhdf") / samples, 6u);
}
}  // namespace
}  // namespace tetwarp::test

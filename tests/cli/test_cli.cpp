/// @file test_cli.cpp
/// The command: files, text and exit codes of each subcommand.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host/warp/backend_choice.hpp"
#include "tests/support/cli_scene.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;

/// The ramp moved by whole voxels along i, as the scene's mesh does it.
std::vector<float> shifted_ramp(int shift) {
  const Volume ramp = ramp_volume<float>();
  const auto source = ramp.samples<float>();
  std::vector<float> shifted(source.size(), 0.0f);
  for (std::size_t v = 0; v < shifted.size(); ++v) {
    const auto i = static_cast<int>(v % 12);
    if (i >= shift) shifted[v] = source[v - static_cast<std::size_t>(shift)];
  }
  return shifted;
}

std::vector<float> samples_of(const Volume& volume) {
  const auto samples = volume.samples<float>();
  return {samples.begin(), samples.end()};
}

TEST(Cli, ShowsVersionAndAnExampleInEveryHelp) {
  const TemporaryFolder folder;
  const CommandResult version = run_command(folder, {"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_EQ(version.out, "tetwarp 0.1.0\n");

  for (const std::string command :
       {"warp", "mesh", "deform", "import", "export", "render", "plot", "info", "demo"}) {
    const CommandResult help = run_command(folder, {command, "--help"});

    EXPECT_EQ(help.exit_code, 0) << command;
    EXPECT_NE(help.out.find("Usage: tetwarp " + command), std::string::npos) << help.out;
    EXPECT_NE(help.out.find("Example:\n  tetwarp " + command), std::string::npos) << help.out;
  }
}

TEST(Cli, WritesOneFilePerStepNamedAfterIt) {
  const Scene scene;

  const CommandResult result = scene.warp({"-o", "out.vtkhdf", "--steps", "0:4:3"});

  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(scene.names(),
            (Names{"mesh.vtkhdf", "out_0000.vtkhdf", "out_0003.vtkhdf", "volume.vtkhdf"}));
  EXPECT_EQ(samples_of(read_volume(scene / "out_0000.vtkhdf")), shifted_ramp(0));
  EXPECT_EQ(samples_of(read_volume(scene / "out_0003.vtkhdf")), shifted_ramp(3));
}

TEST(Cli, WritesASingleStepUnderExactlyTheGivenName) {
  const Scene scene;

  const CommandResult result = scene.warp({"-o", "out.vtkhdf", "--steps", "-1"});

  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(samples_of(read_volume(scene / "out.vtkhdf")), shifted_ramp(3));
  EXPECT_NE(result.out.find("out.vtkhdf"), std::string::npos);
}

TEST(Cli, WritesSeveralVolumesIntoAFolderUnderTheirNames) {
  const Scene scene;
  const Volume other = ramp_volume<std::int16_t>();
  write_volumes(scene / "other.vtkhdf", {&other});

  const CommandResult result = run_command(
      scene, {"warp", "volume.vtkhdf", "other.vtkhdf", "mesh.vtkhdf", "-o", "out", "--steps", "1"});

  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(samples_of(read_volume(scene / "out/volume.vtkhdf")), shifted_ramp(1));
  EXPECT_EQ(read_volume(scene / "out/other.vtkhdf").type, PixelType::int16);
}

TEST(Cli, WritesAllStepsIntoOneTemporalFile) {
  const Scene scene;

  const CommandResult result = scene.warp({"-o", "out.vtkhdf", "--temporal"});

  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(read_volume_header(scene / "out.vtkhdf").times, (std::vector<double>{0, 0.5, 1, 1.5}));
  EXPECT_EQ(samples_of(read_volume(scene / "out.vtkhdf", "", 2)), shifted_ramp(1));
  EXPECT_EQ(samples_of(read_volume(scene / "out.vtkhdf", "", 3)), shifted_ramp(3));
}

TEST(Cli, CutsTheOutputToTheRegionAndMovesItsOrigin) {
  const Scene scene;

  const CommandResult result =
      scene.warp({"-o", "out.vtkhdf", "--steps", "0", "--roi", "2:6,0:10,3:5"});

  EXPECT_EQ(result.exit_code, 0) << result.err;
  const Volume volume = read_volume(scene / "out.vtkhdf");
  EXPECT_EQ(volume.grid.dims, (std::array<std::int64_t, 3>{4, 10, 2}));
  EXPECT_EQ(volume.grid.origin, (Point3{9, -3, 106}));
  EXPECT_EQ(volume.samples<float>()[0], 1.0f + 2 + 3 * 120);
}

TEST(Cli, TakesTheMeshsBoxOnTheSourcesLattice) {
  const Scene scene;

  const CommandResult result = scene.warp({"-o", "out.vtkhdf", "--steps", "3", "--grid", "bounds"});

  EXPECT_EQ(result.exit_code, 0) << result.err;
  const Grid grid = read_volume_header(scene / "out.vtkhdf").grid;
  EXPECT_EQ(grid.dims, (std::array<std::int64_t, 3>{14, 12, 10}));  // -0.5 .. N - 0.5, enclosed
  EXPECT_EQ(grid.origin, (Point3{5 + 2 * 2, -3 - 2, 100 - 2}));
  EXPECT_EQ(grid.spacing, (Point3{2, 2, 2}));
}

TEST(Cli, TakesAnExplicitGridWithCommasOrSpaces) {
  const Scene scene;

  const CommandResult result = run_command(
      scene, {"warp", "--dims", "6", "5", "4", "--spacing=4,4,4", "--origin", "-6,-3,100",
              "volume.vtkhdf", "mesh.vtkhdf", "-o", "out.vtkhdf", "--steps", "0"});

  EXPECT_EQ(result.exit_code, 0) << result.err;
  const Grid grid = read_volume_header(scene / "out.vtkhdf").grid;
  EXPECT_EQ(grid.dims, (std::array<std::int64_t, 3>{6, 5, 4}));
  EXPECT_EQ(grid.spacing, (Point3{4, 4, 4}));
  EXPECT_EQ(grid.origin, (Point3{-6, -3, 100}));
}

TEST(Cli, WritesTheSameFilesWithEverySkipOff) {
  const Scene scene;

  const CommandResult fast = scene.warp({"-o", "fast.vtkhdf"});
  const CommandResult slow = scene.warp({"-o", "slow.vtkhdf", "--no-skip", "all"});

  EXPECT_EQ(fast.exit_code, 0) << fast.err;
  EXPECT_EQ(slow.exit_code, 0) << slow.err;
  for (const std::string step : {"_0000", "_0001", "_0002", "_0003"}) {
    EXPECT_EQ(read_volume(scene / ("fast" + step + ".vtkhdf")).data,
              read_volume(scene / ("slow" + step + ".vtkhdf")).data);
  }
}

TEST(Cli, ReportsCountsTimesAndOutputsAsJson) {
  const Scene scene;

  const CommandResult result =
      scene.warp({"-o", "out.vtkhdf", "--report", "report.json", "--quiet"});

  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, "");
  const auto report = nlohmann::json::parse(text_of(scene / "report.json"));
  EXPECT_EQ(report["status"], "done");
  EXPECT_EQ(report["outputs"].size(), 4u);
  EXPECT_EQ(report["steps"].size(), 4u);
  EXPECT_EQ(report["counts"]["voxels"], 4 * 960);
  EXPECT_EQ(report["counts"]["covered"], 960 + 880 + 880 + 720);
  EXPECT_EQ(report["counts"]["outside"], 4 * 960 - (960 + 880 + 880 + 720));
  EXPECT_EQ(report["counts"]["steps_unchanged"], 1);
  EXPECT_EQ(report["steps"][2]["counts"]["steps_unchanged"], 1);
  EXPECT_EQ(report["steps"][2]["counts"]["inside_tests"], 0);
  std::uintmax_t bytes = 0;
  for (const std::string output : report["outputs"]) bytes += fs::file_size(scene / output);
  EXPECT_EQ(report["counts"]["bytes_written"], bytes);
}

TEST(Cli, NamesTheBackEndInItsOneLineAndTheReasonForItInTheReport) {
  const Scene scene;

  const CommandResult chosen =
      scene.warp({"-o", "out.vtkhdf", "--backend", "reference", "--steps", "0"});
  const CommandResult automatic =
      scene.warp({"-o", "auto.vtkhdf", "--steps", "0", "--report", "report.json"});

  EXPECT_EQ(chosen.exit_code, 0) << chosen.err;
  EXPECT_TRUE(chosen.out.starts_with("1 written, ")) << chosen.out;
  EXPECT_TRUE(chosen.out.ends_with(" s on reference: out.vtkhdf\n")) << chosen.out;
  EXPECT_EQ(automatic.out.find("CUDA"), std::string::npos) << automatic.out;
  EXPECT_EQ(std::count(automatic.out.begin(), automatic.out.end(), '\n'), 1) << automatic.out;
  const auto report = nlohmann::json::parse(text_of(scene / "report.json"));
  const auto [backend, reason] = choose_backend_for(0, {});  // so little work
  EXPECT_EQ(report["backend"], name_of(backend));
  EXPECT_EQ(report["backend_reason"], reason);
}

TEST(Cli, WritesTheFileThatALinkLeadsTo) {
  const Scene scene;
  fs::create_directory(scene / "elsewhere");
  fs::create_symlink("elsewhere/out.vtkhdf", scene / "link.vtkhdf");
  fs::create_symlink("link.vtkhdf", scene / "second.vtkhdf");

  for (const std::string output : {"link.vtkhdf", "second.vtkhdf"}) {
    const CommandResult result = scene.warp({"-o", output, "--steps", "0"});

    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(fs::is_symlink(scene / output));
    EXPECT_EQ(read_volume(scene / "elsewhere/out.vtkhdf").data,
              read_volume(scene / "volume.vtkhdf").data);
    fs::remove(scene / "elsewhere/out.vtkhdf");
  }
}

TEST(Cli, RefusesALinkToAnInput) {
  const Scene scene;
  fs::create_symlink("volume.vtkhdf", scene / "link.vtkhdf");

  const CommandResult result = scene.warp({"-o", "link.vtkhdf", "--steps", "0"});

  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("link.vtkhdf: is also an input"), std::string::npos) << result.err;
}

/// Back ends other than cpu begin a step before the previous one is finished; step 2 repeats step
/// 1.
TEST(Cli, StepsBegunEarlyMakeTheSameFiles) {
  const Scene scene;
  const auto warp = [&](const std::string& backend, std::vector<std::string> more) {
    more.insert(more.end(), {"--backend", backend, "--report", "report.json"});
    const CommandResult result = scene.warp(more);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return nlohmann::json::parse(text_of(scene / "report.json"));
  };
  const auto expect_same = [&](const std::string& a, const std::string& b, std::int64_t step) {
    EXPECT_EQ(read_volume(scene / a, "density", step).data,
              read_volume(scene / b, "density", step).data)
        << a << ' ' << step;
  };
  const nlohmann::json late = warp("cpu", {"-o", "late.vtkhdf"});
  const nlohmann::json early = warp("reference", {"-o", "early.vtkhdf"});
  warp("cpu", {"-o", "late_series.vtkhdf", "--temporal"});
  warp("reference", {"-o", "early_series.vtkhdf", "--temporal"});
  fs::remove(scene / "early_0001.vtkhdf");

  const nlohmann::json again = warp("reference", {"-o", "early.vtkhdf", "--resume"});

  EXPECT_EQ(again["outputs_skipped"], 3);
  for (std::size_t step = 0; step < 4; ++step) {
    const std::string suffix = "_000" + std::to_string(step) + ".vtkhdf";
    expect_same("early" + suffix, "late" + suffix, 0);
    expect_same("early_series.vtkhdf", "late_series.vtkhdf", static_cast<std::int64_t>(step));
    for (const char* count : {"covered", "steps_unchanged", "bytes_read", "bytes_written"}) {
      EXPECT_EQ(early["steps"][step]["counts"][count], late["steps"][step]["counts"][count]);
    }
    EXPECT_EQ(early["steps"][step]["step"], step);
  }
}
}  // namespace
}  // namespace tetwarp::test

/// @file test_cli_pair.cpp
/// Volumes of several steps warped by meshes of several steps.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/cli_scene.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;

/// The ramp times 1, 2 and 3 at three steps; the mesh has four.
class CliPair : public testing::Test {
 protected:
  CliPair() {
    TemporalVolumeWriter writer(scene / "volume.vtkhdf");
    for (int step = 0; step < 3; ++step) {
      Volume volume = ramp_volume<float>();
      for (float& sample : volume.samples<float>()) sample *= static_cast<float>(step + 1);
      writer.append(step, {&volume});
    }
    writer.finish();
  }

  /// Step n of the volume warped by step n of the mesh, in a run of its own.
  Volume alone(int step) const {
    const std::string number = std::to_string(step);
    const CommandResult result = scene.warp(
        {"-o", "alone.vtkhdf", "--steps", number, "--source-step", number, "--overshoot", "clamp"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    return read_volume(scene / "alone.vtkhdf");
  }

  Scene scene;
};

TEST_F(CliPair, WarpsEachStepOfTheVolumeByItsStepOfTheMesh) {
  const CommandResult result = scene.warp({"-o", "out.vtkhdf", "--pair", "--steps", "0:3"});

  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  for (int step = 0; step < 3; ++step) {
    const std::string name = "out_000" + std::to_string(step) + ".vtkhdf";
    EXPECT_EQ(read_volume(scene / name).data, alone(step).data) << step;
  }
  const CommandResult again =
      scene.warp({"-o", "out.vtkhdf", "--pair", "--steps", "0:3", "--resume"});
  EXPECT_NE(again.out.find("0 written, 3 skipped"), std::string::npos) << again.out;
}

/// Steps 1 and 2 of the mesh are equal, those of the volume are not.
TEST_F(CliPair, WritesOneFileWithAllSteps) {
  const Names words{"-o", "out.vtkhdf", "--pair", "--steps", "0:3", "--temporal"};

  const CommandResult result = scene.warp(words);

  EXPECT_EQ(result.exit_code, 0) << result.err;
  for (int step = 0; step < 3; ++step) {
    EXPECT_EQ(read_volume(scene / "out.vtkhdf", "", step).data, alone(step).data) << step;
  }
}

TEST_F(CliPair, WarnsWhereAllStepsTakeOneOfTheVolume) {
  const CommandResult result = scene.warp({"-o", "out.vtkhdf"});

  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.err.find("tetwarp: warning: volume.vtkhdf: all steps of the mesh warp step 0 of "
                            "the 3 steps of the volume; --pair"),
            std::string::npos)
      << result.err;
}

/// The mesh has one step: by it all steps of the volume are warped, in one file with their times.
TEST_F(CliPair, OneDeformationWarpsAllStepsOfASeries) {
  write_mesh(scene / "mesh.vtkhdf", box_mesh(), shifts({1}));
  for (const std::string end : {".vtkhdf", ".nii.gz"}) {
    const CommandResult result =
        scene.warp({"-o", "out" + end, "--outputs", "displacement", "--resume"});

    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.out.find("(3 steps of the volume by the one of the mesh in one file)"),
              std::string::npos)
        << result.out;
    EXPECT_EQ(read_volume_header(scene / ("out" + end)).times, (std::vector<double>{0, 1, 2}));
    for (int step = 0; step < 3; ++step) {
      scene.warp({"-o", "one.vtkhdf", "--source-step", std::to_string(step)});
      EXPECT_EQ(read_volume(scene / ("out" + end), "", step).data,
                read_volume(scene / "one.vtkhdf").data)
          << step;
    }
    const CommandResult again =
        scene.warp({"-o", "out" + end, "--outputs", "displacement", "--resume"});
    EXPECT_NE(again.out.find("0 written"), std::string::npos) << again.out;
  }
  EXPECT_EQ(read_volume_header(scene / "out_displacement.nii.gz").times.size(), 0U)
      << "the field is the same at all steps, and ITK reads no series of fields";
}

TEST_F(CliPair, SaysWhichStepsHaveNoPair) {
  write_mesh(scene / "mesh.vtkhdf", box_mesh(), shifts({1}));

  const CommandResult result = scene.warp({"-o", "out.vtkhdf", "--pair"});

  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.err.find("--pair: the mesh has 1 of the 3 steps of the volume, the others are "
                            "left out; without --pair its one step warps all of them"),
            std::string::npos)
      << result.err;
  EXPECT_NE(result.out.find("(1 pair of steps)"), std::string::npos) << result.out;
  EXPECT_EQ(scene.warp({"-o", "out.vtkhdf", "--pair", "--strict"}).exit_code, 1);
}

TEST_F(CliPair, RefusesStepsWithoutAPair) {
  const CommandResult all = scene.warp({"-o", "out.vtkhdf", "--pair"});
  EXPECT_EQ(all.exit_code, 1);
  EXPECT_NE(all.err.find("volume.vtkhdf: --pair: step 3 of the mesh has no pair, the volume has 3 "
                         "(0 to 2); choose steps of the mesh with --steps"),
            std::string::npos)
      << all.err;

  const CommandResult both = scene.warp({"-o", "out.vtkhdf", "--pair", "--source-step", "1"});
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_NE(both.err.find("leave out --source-step"), std::string::npos) << both.err;
}
}  // namespace
}  // namespace tetwarp::test

/// @file test_cli_resume.cpp
/// --resume and full disks: a file under its final name is complete and correct.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/cli_scene.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;

/// An old time stamp that distinguishes kept files from rewritten ones without waiting.
const fs::file_time_type long_ago = fs::file_time_type::clock::now() - std::chrono::hours(1);

/// A scene with out_0000 ... out_0003 written an hour ago.
class Resume : public testing::Test {
 protected:
  Resume() {
    const CommandResult result = scene.warp({"-o", "out.vtkhdf"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    for (const std::string& output : outputs) fs::last_write_time(scene / output, long_ago);
  }

  /// Resumes and returns the outputs that were written again.
  Names rewritten(Names more = {}) {
    more.insert(more.begin(), {"-o", "out.vtkhdf", "--resume"});
    const CommandResult result = scene.warp(more);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    Names written;
    for (const std::string& output : outputs) {
      if (fs::last_write_time(scene / output) != long_ago) written.push_back(output);
    }
    return written;
  }

  Scene scene;
  const Names outputs{"out_0000.vtkhdf", "out_0001.vtkhdf", "out_0002.vtkhdf", "out_0003.vtkhdf"};
};

TEST_F(Resume, KeepsWhatIsUpToDate) {
  EXPECT_EQ(rewritten(), Names{});

  const CommandResult again = scene.warp({"-o", "out.vtkhdf", "--resume"});
  EXPECT_NE(again.out.find("0 written, 4 skipped"), std::string::npos) << again.out;
}

TEST_F(Resume, IsUnmovedByOptionsThatDoNotChangeTheResult) {
  EXPECT_EQ(rewritten({"--no-skip", "all", "--threads", "1"}), Names{});
}

TEST_F(Resume, WritesEverythingAgainWithoutTheOption) {
  EXPECT_EQ(scene.warp({"-o", "out.vtkhdf"}).exit_code, 0);

  for (const std::string& output : outputs) {
    EXPECT_NE(fs::last_write_time(scene / output), long_ago);
  }
}

TEST_F(Resume, FillsInWhatIsMissing) {
  fs::remove(scene / "out_0001.vtkhdf");
  fs::remove(scene / "out_0002.vtkhdf");

  EXPECT_EQ(rewritten(), (Names{"out_0001.vtkhdf", "out_0002.vtkhdf"}));
  EXPECT_EQ(read_volume(scene / "out_0001.vtkhdf").data,
            read_volume(scene / "out_0002.vtkhdf").data);
}

TEST_F(Resume, WritesATruncatedFileAgain) {
  const std::string output = scene / "out_0002.vtkhdf";
  fs::resize_file(output, fs::file_size(output) - 100);
  fs::last_write_time(output, long_ago);

  EXPECT_EQ(rewritten(), Names{"out_0002.vtkhdf"});
}

TEST_F(Resume, WritesAgainAfterAChangeOfOneSample) {
  Volume volume = ramp_volume<float>();
  volume.samples<float>()[17] += 1;
  write_volumes(scene / "volume.vtkhdf", {&volume});

  EXPECT_EQ(rewritten(), outputs);
}

TEST_F(Resume, WritesAgainTheOneStepThatMoved) {
  write_mesh(scene / "mesh.vtkhdf", box_mesh(), shifts({0, 1, 2, 3}), {0, 0.5, 1, 1.5});

  EXPECT_EQ(rewritten(), Names{"out_0002.vtkhdf"});
}

TEST_F(Resume, WritesAgainAfterAChangeOfAnOption) {
  EXPECT_EQ(rewritten({"--filter", "nearest"}), outputs);
  EXPECT_EQ(rewritten({"--filter", "cubic"}), outputs);
  EXPECT_EQ(rewritten({"--filter", "cubic", "--overshoot", "clamp"}), outputs);
  EXPECT_EQ(rewritten({"--background", "-7"}), outputs);
  EXPECT_EQ(rewritten({"--outputs", "mask"}), outputs);
}

TEST(Temporal, ResumesOnlyWhenEveryStepIsTheSame) {
  const Scene scene;
  const Names words{"-o", "out.vtkhdf", "--temporal", "--resume"};
  EXPECT_EQ(scene.warp(words).exit_code, 0);
  fs::last_write_time(scene / "out.vtkhdf", long_ago);

  EXPECT_EQ(scene.warp(words).exit_code, 0);
  EXPECT_EQ(fs::last_write_time(scene / "out.vtkhdf"), long_ago);

  write_mesh(scene / "mesh.vtkhdf", box_mesh(), shifts({0, 1, 1, 4}), {0, 0.5, 1, 1.5});
  EXPECT_EQ(scene.warp(words).exit_code, 0);
  EXPECT_NE(fs::last_write_time(scene / "out.vtkhdf"), long_ago);
}

/// An interrupted run leaves complete steps, here 0 and 1 of 0 to 3. Of two equal steps the second
/// one is not stored again.
TEST(Temporal, GoesOnAfterTheStepsThatAreComplete) {
  const Scene scene;
  const Names more{"--outputs", "mask", "--report", "report.json"};
  const auto with = [&](Names words) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  EXPECT_EQ(scene.warp(with({"-o", "step.vtkhdf"})).exit_code, 0);
  EXPECT_EQ(scene.warp(with({"-o", "direct.vtkhdf", "--temporal"})).exit_code, 0);
  for (const std::string output : {"out.vtkhdf", "out.nii.gz"}) {
    const fs::path folder = scene / (output + ".steps");
    fs::create_directory(folder);
    for (const std::string step : {"0000", "0001"}) {
      fs::copy_file(scene / ("step_" + step + ".vtkhdf"), folder / ("step_" + step + ".vtkhdf"));
    }

    const CommandResult result = scene.warp(with({"-o", output, "--temporal", "--resume"}));

    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_FALSE(fs::exists(folder));
    const auto report = nlohmann::json::parse(text_of(scene / "report.json"));
    EXPECT_EQ(report["counts"]["voxels"], 2 * 960);
    EXPECT_EQ(report["outputs_skipped"], 0);
    for (const std::int64_t step : {0, 1, 2, 3}) {
      const std::string array = output == "out.vtkhdf" ? "density" : "";
      EXPECT_EQ(read_volume(scene / output, array, step).data,
                read_volume(scene / "direct.vtkhdf", "density", step).data);
    }
  }
  EXPECT_LT(fs::file_size(scene / "out.vtkhdf"),
            1.1 * static_cast<double>(fs::file_size(scene / "direct.vtkhdf")));
}

/// With little memory the steps are copied brick by brick.
TEST(Temporal, IsTheSameInBlocksWhenItCanBeResumed) {
  if (has_address_sanitizer) GTEST_SKIP() << "the address sanitizer takes more memory";
  const Scene scene;
  const Names words{"--temporal", "--memory", "60M", "--outputs", "displacement"};
  Volume volume = make_volume(ramp_volume<float>().grid, PixelType::float32, 1, "density");
  volume.grid.dims = {120, 110, 100};
  volume.grid.spacing = {0.2, 2.0 / 11, 0.16};
  volume.data.resize(volume.byte_count());
  for (std::size_t v = 0; v < volume.samples<float>().size(); ++v) {
    volume.samples<float>()[v] = static_cast<float>(v % 977);
  }
  write_volumes(scene / "volume.vtkhdf", {&volume});
  for (const std::string output : {"direct.vtkhdf", "resumed.vtkhdf"}) {
    Names all{"-o", output};
    all.insert(all.end(), words.begin(), words.end());
    if (output == "resumed.vtkhdf") all.push_back("--resume");

    const CommandResult result = scene.warp(all);

    EXPECT_EQ(result.exit_code, 0) << result.err;
  }
  for (const std::string array : {"density", "tetwarp_displacement"}) {
    EXPECT_EQ(read_volume(scene / "resumed.vtkhdf", array, 3).data,
              read_volume(scene / "direct.vtkhdf", array, 3).data);
  }
}

TEST(FullDisk, IsOneLineAndLeavesNothing) {
  const Scene scene;
  for (const Names& words :
       {Names{"-o", "out.vtkhdf", "--steps", "0"}, Names{"-o", "out.vtkhdf", "--temporal"},
        Names{"-o", "out.vtkhdf", "--steps", "0", "--compress", "1"}}) {
    const CommandResult result = scene.warp(words, {.file_size_limit = 2000});

    EXPECT_EQ(result.exit_code, 1);
    EXPECT_TRUE(result.has_one_line_error()) << result.err;
    EXPECT_EQ(scene.names(), scene.inputs);
  }
}

TEST(FullDisk, KeepsAnOlderOutput) {
  const Scene scene;
  EXPECT_EQ(scene.warp({"-o", "out.vtkhdf", "--steps", "0"}).exit_code, 0);
  const std::string before = text_of(scene / "out.vtkhdf");

  const CommandResult result =
      scene.warp({"-o", "out.vtkhdf", "--steps", "3"}, {.file_size_limit = 2000});

  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(text_of(scene / "out.vtkhdf"), before);
}

TEST(FullDisk, IsAnErrorOfStandardOutput) {
  const Scene scene;

  const CommandResult result = run_command(scene, {"info", "volume.vtkhdf"}, {.out = "/dev/full"});

  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(result.has_one_line_error()) << result.err;
}
}  // namespace
}  // namespace tetwarp::test

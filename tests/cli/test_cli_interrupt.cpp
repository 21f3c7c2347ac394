/// @file test_cli_interrupt.cpp
/// Ctrl-C in every phase: a line at once, the end within a second, no temporary file; what a killed
/// run leaves; the progress bar.
#include <gtest/gtest.h>
#include <nifti1.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <tetwarp/io.hpp>
#include <tetwarp/make.hpp>
#include <vector>

#include "io/nifti/nifti_header.hpp"
#include "tests/support/running_scene.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;

/// Seconds from a signal to the end of a command: one is promised, the rest is for a busy machine.
constexpr double max_seconds = 3;

struct Ending {
  CommandResult result;
  double seconds = 0;  ///< since the signal
};

Ending end_by(int signal, RunningCommand& command) {
  const auto start = std::chrono::steady_clock::now();
  kill(command.process(), signal);
  Ending ending{command.wait()};
  ending.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return ending;
}

/// Ends a running command by SIGINT: in time, with one line, and without files left behind.
void expect_clean_end(RunningCommand& command, const Scene& scene, const std::string& line) {
  const Ending ending = end_by(SIGINT, command);

  EXPECT_EQ(ending.result.exit_code, 130);
  EXPECT_LT(ending.seconds, max_seconds);
  EXPECT_EQ(ending.result.err, line);
  EXPECT_EQ(scene.names(), scene.inputs);
}

TEST(Interrupt, LeavesNoTemporalFileAndNoTemporary) {
  const Scene scene;
  write_long_mesh(scene);
  const FolderWatch watch(scene);
  RunningCommand command(
      scene, {"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o", "out.vtkhdf", "--temporal"});
  ASSERT_TRUE(watch.sees_new_file());

  kill(command.process(), SIGINT);
  const CommandResult result = command.wait();

  EXPECT_EQ(result.exit_code, 130);
  EXPECT_EQ(result.err, "tetwarp: interrupted, stopping\n");
  EXPECT_EQ(scene.names(), scene.inputs);
}

/// While a gzip image is unpacked for blocks, and while blocks stand in a temporary file.
TEST(Interrupt, LeavesNothingOfAnUnpackedImage) {
  const Scene scene;
  write_long_mesh(scene, 40);
  Volume volume = make_volume(ramp_volume<float>().grid, PixelType::float32);
  volume.grid.dims = {160, 150, 140};
  volume.grid.spacing = {24.0 / 160, 20.0 / 150, 16.0 / 140};
  volume.data.resize(volume.byte_count());
  write_nifti(scene / "large.nii.gz", volume);
  const FolderWatch watch(scene);
  RunningCommand command(scene, {"warp", "large.nii.gz", "mesh.vtkhdf", "-o", "out.nii.gz",
                                 "--temporal", "--memory", "70M", "--threads", "2"});
  ASSERT_TRUE(watch.sees_new_file());

  const Ending ending = end_by(SIGINT, command);

  EXPECT_EQ(ending.result.exit_code, 130);
  EXPECT_LT(ending.seconds, max_seconds);
  EXPECT_EQ(scene.names(), (Names{"large.nii.gz", "mesh.vtkhdf", "volume.vtkhdf"}));
}

/// 1.5 GB of zeros, as gzip files that follow each other.
void write_large_image(const Scene& scene, const std::string& name) {
  Volume small = make_volume(ramp_volume<float>().grid, PixelType::uint8);
  small.grid.spacing = {24.0 / 1024, 20.0 / 1024, 16.0 / 1536};
  write_nifti(scene / "small.nii", small);
  std::string header = text_of(scene / "small.nii");
  nifti_1_header fields{};
  std::memcpy(&fields, header.data(), sizeof fields);
  const std::array<short, 3> dims{1024, 1024, 1536};
  std::ranges::copy(dims, fields.dim + 1);
  std::memcpy(header.data(), &fields, sizeof fields);
  header.resize(static_cast<std::size_t>(fields.vox_offset));
  const std::string zeros(std::size_t{1} << 26, '\0');
  const auto packed = [&](const std::string& bytes) {
    NiftiStream(scene / "part.gz", "wb", true).write(bytes.data(), bytes.size());
    return text_of(scene / "part.gz");
  };
  std::string image = packed(header);
  const std::string part = packed(zeros);
  for (int copy = 0; copy < 24; ++copy) image += part;
  fs::remove(scene / "part.gz");
  fs::remove(scene / "small.nii");
  write_text(scene / name, image);
}

/// Unpacking it takes longer than the timer allows that ends a command without a report.
TEST(Interrupt, EndsTheUnpackingOfALargeImageInTimeForTheReport) {
  const Scene scene;
  write_large_image(scene, "large.nii.gz");
  write_text(
      scene / "jobs.json",
      R"({"jobs": [{"volume": "large.nii.gz", "mesh": "mesh.vtkhdf", "output": "out.nii.gz"}]})");
  fs::create_directory(scene / "reports");
  const Names before = scene.names();
  const FolderWatch watch(scene);
  RunningCommand command(scene, {"warp", "--batch", "jobs.json", "--steps", "3", "--memory", "70M",
                                 "--threads", "1", "--report", "reports/batch.json"});
  ASSERT_TRUE(watch.sees_new_file());

  const Ending ending = end_by(SIGINT, command);

  EXPECT_EQ(ending.result.exit_code, 130);
  EXPECT_LT(ending.seconds, max_seconds);
  EXPECT_EQ(scene.names(), before);
  const auto report = nlohmann::json::parse(text_of(scene / "reports/batch.json"));
  EXPECT_EQ(report["status"], "interrupted");
  EXPECT_EQ(report["jobs"][0]["status"], "interrupted");
}

/// While a gzip field is unpacked, and while parts of the output are computed.
TEST(Interrupt, LeavesNothingOfAnUnpackedField) {
  const Scene scene;
  Grid grid = ramp_volume<float>().grid;
  grid.dims = {160, 150, 140};
  write_nifti(scene / "field.nii.gz", make_volume(grid, PixelType::float32, 3), Axes::lps);
  write_nifti(scene / "image.nii", make_volume(grid, PixelType::float32));
  const Names before = scene.names();
  const FolderWatch watch(scene);
  RunningCommand command(scene, {"warp", "image.nii", "field.nii.gz", "-o", "out.nii", "--filter",
                                 "lanczos", "--memory", "80M", "--threads", "1"});
  ASSERT_TRUE(watch.sees_new_file());

  const Ending ending = end_by(SIGINT, command);

  EXPECT_EQ(ending.result.exit_code, 130);
  EXPECT_LT(ending.seconds, max_seconds);
  EXPECT_EQ(scene.names(), before);
}

TEST(Interrupt, LeavesOnlyCompleteStepsThatResumeKeeps) {
  const Scene scene;
  write_long_mesh(scene);
  const FolderWatch watch(scene);
  RunningCommand command(scene, {"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o", "out.vtkhdf"});
  ASSERT_TRUE(watch.sees_new_file());

  kill(command.process(), SIGTERM);
  const CommandResult result = command.wait();

  EXPECT_EQ(result.exit_code, 130);
  for (const std::string& name : scene.names()) {
    EXPECT_FALSE(name.starts_with(".")) << name;
    if (name.starts_with("out")) {
      EXPECT_TRUE(read_fingerprint(scene / name).has_value()) << name;
    }
  }
}

TEST(Interrupt, StopsAConservativeWarpWithinASecond) {
  const TemporaryFolder folder;
  const Volume phantom = make_phantom({128, 128, 128});
  const Mesh mesh = make_lattice_mesh(phantom);
  write_volumes(folder / "volume.vtkhdf", {&phantom});
  write_mesh(folder / "mesh.vtkhdf", mesh);
  Terminal terminal(80);
  RunningCommand command(
      folder,
      {"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o", "out.vtkhdf", "--intensity", "conservative"},
      {.err = terminal.name()});
  ASSERT_NE(terminal.wait_for(" left").find(" left"), std::string::npos);

  const Ending ending = end_by(SIGINT, command);

  EXPECT_EQ(ending.result.exit_code, 130);
  EXPECT_LT(ending.seconds, max_seconds);
  EXPECT_TRUE(terminal.text().ends_with("\033[Ktetwarp: interrupted, stopping\r\n"))
      << terminal.text();
  EXPECT_EQ(folder.names(), (Names{"mesh.vtkhdf", "volume.vtkhdf"}));
}

/// Compressing noise takes seconds and checks no flag.
TEST(Interrupt, StopsCompressionWithinASecond) {
  const Scene scene;
  Grid grid;
  grid.dims = {240, 240, 240};
  Volume noise = make_volume(grid, PixelType::float32, 1, "noise");
  std::minstd_rand random;
  for (float& sample : noise.samples<float>()) sample = static_cast<float>(random());
  write_volumes(scene / "volume.vtkhdf", {&noise});
  const FolderWatch watch(scene);
  RunningCommand command(scene, {"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o", "out.vtkhdf",
                                 "--steps", "0", "--outside", "identity", "--compress", "9"});
  ASSERT_TRUE(watch.sees_new_file());

  expect_clean_end(command, scene, "tetwarp: interrupted, stopping\n");
}

TEST(Interrupt, EndsOtherCommandsAtOnce) {
  const Scene scene;
  const FolderWatch watch(scene);
  RunningCommand command(scene,
                         {"deform", "mesh.vtkhdf", "-o", "moving.vtkhdf", "--steps", "1000000"});
  ASSERT_TRUE(watch.sees_new_file());

  expect_clean_end(command, scene, "tetwarp: interrupted\n");
}

TEST(Interrupt, LeavesTheReportOfABatch) {
  const Scene scene;
  write_long_mesh(scene);
  write_text(scene / "jobs.json", R"({"jobs": [
      {"volume": "volume.vtkhdf", "mesh": "mesh.vtkhdf", "output": "a.vtkhdf", "steps": 0},
      {"volume": "volume.vtkhdf", "mesh": "mesh.vtkhdf", "output": "b.vtkhdf", "temporal": true},
      {"volume": "volume.vtkhdf", "mesh": "mesh.vtkhdf", "output": "c.vtkhdf", "steps": 0}]})");
  Terminal terminal(80);
  RunningCommand command(scene, {"warp", "--batch", "jobs.json", "--report", "report.json"},
                         {.err = terminal.name()});
  ASSERT_NE(terminal.wait_for("job 2 [").find("job 2 ["), std::string::npos);

  const Ending ending = end_by(SIGINT, command);

  EXPECT_EQ(ending.result.exit_code, 130);
  const auto report = nlohmann::json::parse(text_of(scene / "report.json"));
  EXPECT_EQ(report["status"], "interrupted");
  EXPECT_EQ(report["jobs_done"], 1);
  EXPECT_EQ(report["jobs"][0]["status"], "done");
  EXPECT_FALSE(fs::exists(scene / "c.vtkhdf"));
}

TEST(Killed, LeavesATemporaryFileThatTheNextRunRemoves) {
  const Scene scene;
  write_long_mesh(scene);
  const FolderWatch watch(scene);
  RunningCommand command(
      scene, {"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o", "out.vtkhdf", "--temporal"});
  ASSERT_TRUE(watch.sees_new_file());
  end_by(SIGKILL, command);
  ASSERT_EQ(scene.names().size(), 3u) << "a temporary file";
  const std::string of_another_machine = ".1-00000000.0.tmp.out.vtkhdf";
  write_text(scene / of_another_machine, "");
  write_mesh(scene / "mesh.vtkhdf", box_mesh(), shifts({0, 1}), {0, 1});

  const CommandResult result = scene.warp({"-o", "out.vtkhdf", "--temporal", "--resume"});

  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(scene.names(),
            (Names{of_another_machine, "mesh.vtkhdf", "out.vtkhdf", "volume.vtkhdf"}));
}

/// The number behind `word`, or before it.
double number_after(const std::string& line, const std::string& word) {
  return std::stod(line.substr(line.find(word) + word.size()));
}
double percent_of(const std::string& line) {
  const std::size_t end = line.find('%');
  return std::stod(line.substr(end - 2, 2));
}

TEST(ProgressBar, StaysOnOneLineAndNeverRunsBackwards) {
  const Scene scene;
  write_long_mesh(scene, 2000);
  for (const std::uint16_t columns : std::vector<std::uint16_t>{80, 44}) {
    Terminal terminal(columns);
    RunningCommand command(scene,
                           {"warp", "volume.vtkhdf", "mesh.vtkhdf", "-o",
                            std::to_string(columns) + ".vtkhdf", "--temporal"},
                           {.err = terminal.name()});
    const std::string text = terminal.text_until_end_of(command);
    EXPECT_EQ(command.wait().exit_code, 0);
    double percent = 0, step = 0;
    std::size_t lines = 0;
    for (std::size_t at = text.find("\r\033[K"); at != std::string::npos;) {
      const std::size_t next = text.find("\r\033[K", at + 4);
      const std::string line = text.substr(at + 4, next - at - 4);
      at = next;
      EXPECT_LT(line.size(), columns) << line;
      EXPECT_EQ(line.find('\n'), std::string::npos) << line;
      if (line.find(" of 2000") == std::string::npos) continue;
      ++lines;
      EXPECT_GE(percent_of(line), percent) << line;
      EXPECT_GE(number_after(line, "step "), step) << line;
      percent = percent_of(line);
      step = number_after(line, "step ");
    }
    EXPECT_GT(lines, 2u) << text;
  }
}
}  // namespace
}  // namespace tetwarp::test

/// @file test_cli_memory_peak.cpp
/// --memory bounds the memory that the operating system measures, and its errors name limits that
/// work.
#include <gtest/gtest.h>
#include <hdf5.h>

#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/cli_scene.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {
namespace {
constexpr double megabyte = 1 << 20;  // the unit of M in --memory
constexpr double tolerance = 1.02;

/// 160^3 voxels of one byte and a bent mesh: with all outputs 340 MB.
class PeakMemory : public testing::Test {
 protected:
  PeakMemory() {
    Volume volume = scenes::wavy_volume(grid_, PixelType::uint8);
    volume.name = "density";
    write_volumes(folder / "rows.vtkhdf", {&volume});
    write_layout("contiguous.vtkhdf", volume, 0, 0);
    write_layout("deflated.vtkhdf", volume, 75, 6);
    write_nifti(folder / "head.nii", volume);
    write_nifti(folder / "head.nii.gz", volume);
    const Mesh mesh = scenes::lattice({6, 6, 4}, {-0.5, -0.5, -0.5}, {159.5, 159.5, 159.5});
    std::vector<Point3> shifts = scenes::waved(mesh.rest_positions, 5, 3);
    for (std::size_t n = 0; n < shifts.size(); ++n) {
      for (std::size_t axis = 0; axis < 3; ++axis) shifts[n][axis] -= mesh.rest_positions[n][axis];
    }
    write_mesh(folder / "mesh.vtkhdf", mesh, {shifts}, {0});
  }

  /// @param edge   of cubic chunks; 0: contiguous
  /// @param level  of deflate
  void write_layout(const std::string& name, const Volume& volume, hsize_t edge, unsigned level) {
    write_volumes(folder / name, {&volume});
    const hid_t file = H5Fopen((folder / name).c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    const char* const path = "/VTKHDF/PointData/density";
    const hsize_t dims[] = {160, 160, 160}, chunk[] = {edge, edge, edge};
    const hid_t space = H5Screate_simple(3, dims, nullptr);
    const hid_t layout = H5Pcreate(H5P_DATASET_CREATE);
    if (edge > 0) H5Pset_chunk(layout, 3, chunk);
    if (level > 0) H5Pset_deflate(layout, level);
    H5Ldelete(file, path, H5P_DEFAULT);
    const hid_t data =
        H5Dcreate2(file, path, H5T_STD_U8LE, space, H5P_DEFAULT, layout, H5P_DEFAULT);
    H5Dwrite(data, H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, volume.data.data());
    H5Dclose(data);
    H5Pclose(layout);
    H5Sclose(space);
    H5Fclose(file);
  }

  CommandResult warp(const std::string& volume,
                     std::vector<std::string> words,
                     const std::string& output = "out.vtkhdf") const {
    words.insert(words.begin(), {"warp", volume, "mesh.vtkhdf", "-o", output, "--outputs",
                                 "mask,tet,displacement,jacobian", "--threads", "2"});
    return run_command(folder, words);
  }

  /// The number that the error of a limit that is too low names [megabyte].
  static int least_of(const CommandResult& refused) {
    const std::string marker = "at least ";
    const std::size_t at = refused.err.find(marker);
    EXPECT_TRUE(refused.has_one_line_error()) << refused.err;
    EXPECT_NE(at, std::string::npos) << refused.err;
    return at == std::string::npos ? 0 : std::stoi(refused.err.substr(at + marker.size()));
  }

  TemporaryFolder folder;

 private:
  Grid grid_ = scenes::unit_grid(160, 160, 160);
};

TEST_F(PeakMemory, KeepsToTheLimitWhateverTheLayoutOfTheSource) {
  for (const char* volume : {"contiguous.vtkhdf", "rows.vtkhdf", "deflated.vtkhdf"}) {
    const CommandResult result = warp(volume, {"--memory", "60M", "--filter", "cubic"});

    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_LE(result.peak_memory, tolerance * 60 * megabyte) << volume;
  }
}

TEST_F(PeakMemory, KeepsToTheLimitWithEveryFilterAndOutput) {
  for (const std::vector<std::string>& words : {std::vector<std::string>{"--filter", "nearest"},
                                                {"--filter", "linear"},
                                                {"--filter", "lanczos"},
                                                {"--filter", "labels"},
                                                {"--antialias"},
                                                {"--intensity", "density"},
                                                {"--outside", "identity"},
                                                {"--outputs", "gradient,strain"}}) {
    std::vector<std::string> limited = words;
    limited.insert(limited.end(), {"--memory", "80M"});
    const CommandResult result = warp("deflated.vtkhdf", limited);

    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_LE(result.peak_memory, tolerance * 80 * megabyte) << words.back();
  }
}

TEST_F(PeakMemory, KeepsToTheLimitFromNiftiToNifti) {
  for (const std::string end : {".nii", ".nii.gz"}) {
    const std::vector<std::string> words{"--memory", "60M", "--filter", "cubic"};
    const CommandResult result = warp("head" + end, words, "out" + end);

    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_LE(result.peak_memory, tolerance * 60 * megabyte) << end;
  }
}

TEST_F(PeakMemory, TheLeastLimitIsNamedAndWorks) {
  for (const std::string volume : {"rows.vtkhdf", "deflated.vtkhdf", "head.nii.gz"}) {
    const CommandResult refused = warp(volume, {"--memory", "16M"});
    const CommandResult planned = warp(volume, {"--memory", "16M", "--dry-run"});
    const int least = least_of(refused);
    const std::string limit = std::to_string(least) + "M";

    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_EQ(planned.exit_code, 1);
    EXPECT_NEAR(least_of(planned), least, 1);
    EXPECT_EQ(warp(volume, {"--memory", std::to_string(least - 4) + "M"}).exit_code, 1);
    EXPECT_EQ(warp(volume, {"--memory", limit, "--dry-run"}).exit_code, 0);
    const CommandResult run = warp(volume, {"--memory", limit});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_LE(run.peak_memory, tolerance * least * megabyte);
  }
}

TEST_F(PeakMemory, WhatNeedsEverythingAtOnceNamesItsLimitToo) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"--filter", "bspline"}, {"--intensity", "conservative"}}) {
    std::vector<std::string> low = words, enough = words;
    low.insert(low.end(), {"--memory", "32M"});
    const int least = least_of(warp("deflated.vtkhdf", low));
    enough.insert(enough.end(), {"--memory", std::to_string(least) + "M"});
    const CommandResult run = warp("deflated.vtkhdf", enough);

    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_LE(run.peak_memory, tolerance * least * megabyte) << words.back();
  }
}

TEST_F(PeakMemory, ADryRunSaysThatMemoryIsMissing) {
  const CommandResult result =
      run_command(folder, {"warp", "rows.vtkhdf", "mesh.vtkhdf", "-o", "out.vtkhdf", "--dims",
                           "50000,50000,50000", "--spacing", "0.003,0.003,0.003", "--dry-run"});

  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(result.has_one_line_error()) << result.err;
  EXPECT_NE(result.err.find("are available; use --memory"), std::string::npos) << result.err;
  EXPECT_NE(result.out.find("50000 x 50000 x 50000 voxels"), std::string::npos) << result.out;
}
}  // namespace
}  // namespace tetwarp::test

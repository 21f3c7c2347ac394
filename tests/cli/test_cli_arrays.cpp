/// @file test_cli_arrays.cpp
/// Which array of a volume the commands take.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/cli_scene.hpp"
#include "tests/support/io_files.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;

std::vector<std::string> array_names(const std::string& path) {
  std::vector<std::string> names;
  for (const ArrayHeader& array : read_volume_header(path).arrays) names.push_back(array.name);
  return names;
}

TEST(CliArrays, ExportRenderAndMeshTakeTheImageAndNotAFieldOfTheDeformation) {
  const Scene scene;
  const Volume volume = ramp_volume<float>("zebra");
  write_volumes(scene / "volume.vtkhdf", {&volume});
  const std::string taken =
      "tetwarp: out.vtkhdf: takes array zebra of zebra, tetwarp_displacement; --array names "
      "another\n";

  const CommandResult warped = scene.warp(
      {"-o", "out.vtkhdf", "--steps", "0", "--outputs", "displacement", "--memory", "1G"});

  EXPECT_EQ(warped.exit_code, 0) << warped.err;
  EXPECT_EQ(read_volume(scene / "out.vtkhdf").name, "zebra");
  for (const Names& words : std::vector<Names>{{"export", "out.vtkhdf", "-o", "out.nii"},
                                               {"render", "out.vtkhdf", "-o", "out.png"},
                                               {"mesh", "out.vtkhdf", "-o", "lattice.vtkhdf"}}) {
    const CommandResult result = run_command(scene, words);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, taken);
  }
  EXPECT_EQ(read_nifti(scene / "out.nii").data, volume.data);
  const CommandResult named =
      run_command(scene, {"export", "out.vtkhdf", "-o", "out.nii", "--array", "zebra"});
  EXPECT_EQ(named.err, "");
}

TEST(CliArrays, WarpKeepsTheirOrderAndTheActiveOne) {
  const Scene scene;
  const Volume b = ramp_volume<float>("b"), a = ramp_volume<std::uint16_t>("a");
  const Volume c = ramp_volume<std::int16_t>("c");
  write_volumes(scene / "volume.vtkhdf", {&b, &a, &c}, {.scalars = "c"});

  const CommandResult all = scene.warp({"-o", "all.vtkhdf", "--steps", "0", "--outputs", "mask"});
  const CommandResult series = scene.warp({"-o", "series.vtkhdf", "--temporal"});
  const CommandResult two =
      scene.warp({"-o", "two.vtkhdf", "--steps", "0", "--array", "b", "--array", "a"});

  for (const CommandResult& result : {all, series, two}) {
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
  }
  EXPECT_EQ(array_names(scene / "all.vtkhdf"), (Names{"b", "a", "c", "tetwarp_mask"}));
  EXPECT_EQ(read_volume(scene / "all.vtkhdf").name, "c");
  EXPECT_EQ(array_names(scene / "series.vtkhdf"), (Names{"b", "a", "c"}));
  EXPECT_EQ(read_volume(scene / "series.vtkhdf").name, "c");
  EXPECT_EQ(array_names(scene / "two.vtkhdf"), (Names{"b", "a"}));
  EXPECT_EQ(read_volume(scene / "two.vtkhdf").name, "b");
}

/// Adds to the ramp what other programs write: booleans as h5py stores them, float16, complex
/// numbers, cell data and field data.
void add_foreign_arrays(const std::string& path) {
  const std::vector<hsize_t> dims{8, 10, 12};
  const hid_t boolean = H5Tenum_create(H5T_STD_I8LE);
  const std::int8_t off = 0, on = 1;
  H5Tenum_insert(boolean, "FALSE", &off);
  H5Tenum_insert(boolean, "TRUE", &on);
  const hid_t half = H5Tcopy(H5T_IEEE_F32LE);
  H5Tset_fields(half, 15, 10, 5, 0, 10);
  H5Tset_size(half, 2);
  H5Tset_ebias(half, 15);
  const hid_t pair = H5Tcreate(H5T_COMPOUND, 8);
  H5Tinsert(pair, "r", 0, H5T_IEEE_F32LE);
  H5Tinsert(pair, "i", 4, H5T_IEEE_F32LE);
  Hdf5Editor(path)
      .dataset("VTKHDF/PointData/half", dims, std::vector<float>(960, 0.5F), half)
      .dataset("VTKHDF/PointData/wave", dims, std::vector<float>(), pair)
      .group("VTKHDF/CellData")
      .dataset("VTKHDF/CellData/part", {7, 9, 11}, std::vector<std::uint8_t>(693, 1))
      .group("VTKHDF/FieldData")
      .dataset("VTKHDF/FieldData/dose", {1}, std::vector<double>{60})
      .dataset("VTKHDF/PointData/bits", dims, std::vector<std::uint8_t>(960, 1), boolean);
  for (const hid_t type : {boolean, half, pair}) H5Tclose(type);
}

TEST(CliArrays, WarpKeepsBooleansAndNamesWhatItDoesNotKeep) {
  const Scene scene;
  add_foreign_arrays(scene / "volume.vtkhdf");

  const CommandResult result = scene.warp({"-o", "out.vtkhdf", "--steps", "3"});
  const CommandResult named =
      scene.warp({"-o", "named.vtkhdf", "--steps", "3", "--array", "bits", "--strict"});

  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err,
            "tetwarp: warning: volume.vtkhdf: not warped: PointData/wave, CellData/part, "
            "FieldData/dose; float16 becomes float32: half; --array names what to warp\n");
  EXPECT_EQ(array_names(scene / "out.vtkhdf"), (Names{"density", "half", "bits"}));
  EXPECT_EQ(read_volume(scene / "out.vtkhdf").name, "density");
  EXPECT_EQ(named.exit_code, 0) << named.err;
  EXPECT_EQ(named.err, "");
  const Volume bits = read_volume(scene / "named.vtkhdf");
  ASSERT_EQ(bits.type, PixelType::uint8);
  for (std::size_t v = 0; v < 960; ++v) {
    ASSERT_EQ(bits.samples<std::uint8_t>()[v], v % 12 >= 3 ? 1 : 0) << v;
  }
}
}  // namespace
}  // namespace tetwarp::test

/// @file test_cli_bad_layouts.cpp
/// HDF5 files with a wrong layout straight into the command, and meshes that do not do what their
/// file seems to say.
#include <gtest/gtest.h>
#include <hdf5.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "tests/support/cli_scene.hpp"
#include "tests/support/refused_line.hpp"

namespace tetwarp::test {
namespace {
using Names = std::vector<std::string>;
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// Replaces an attribute of /VTKHDF or of a group in it by numbers.
void set_attribute(hid_t file,
                   const char* group,
                   const char* name,
                   const std::vector<double>& numbers) {
  const hid_t object = H5Oopen(file, group, H5P_DEFAULT);
  const hsize_t count = numbers.size();
  const hid_t space = H5Screate_simple(1, &count, nullptr);
  H5Adelete(object, name);
  const hid_t attribute = H5Acreate2(object, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT);
  H5Awrite(attribute, H5T_NATIVE_DOUBLE, numbers.data());
  H5Aclose(attribute);
  H5Sclose(space);
  H5Oclose(object);
}

/// Replaces a dataset by one of zeros, or of the numbers.
void set_dataset(hid_t file,
                 const char* path,
                 hid_t type,
                 const std::vector<hsize_t>& dims,
                 const std::vector<double>& numbers = {}) {
  H5Ldelete(file, path, H5P_DEFAULT);
  const hid_t space = H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr);
  const hid_t data = H5Dcreate2(file, path, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  std::vector<double> all = numbers;
  all.resize(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  const bool is_text = H5Tget_class(type) == H5T_STRING;
  H5Dwrite(data, is_text ? type : H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data());
  H5Dclose(data);
  H5Sclose(space);
}

/// A change of a good file and what the line about it must hold.
struct BadLayout {
  std::function<void(hid_t)> change;
  std::string phrase;
};

void make_bad(const std::string& good, const std::string& bad, const BadLayout& layout) {
  fs::copy_file(good, bad, fs::copy_options::overwrite_existing);
  const hid_t file = H5Fopen(bad.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  layout.change(file);
  H5Fclose(file);
}

TEST(BadLayouts, VolumesNameTheDataset) {
  const Scene scene;
  const char* const array = "/VTKHDF/PointData/density";
  const hid_t f32 = H5T_IEEE_F32LE;
  for (const BadLayout& bad : std::vector<BadLayout>{
           {[](hid_t f) {
              set_attribute(f, "/VTKHDF", "Spacing", {1, 1});
            },
            "bad.vtkhdf: /VTKHDF: attribute Spacing holds 2 numbers, expected 3 numbers"},
           {[](hid_t f) {
              set_attribute(f, "/VTKHDF", "Direction", {1, 0, 0, 1, 0, 0, 0, 0, 1});
            },
            "direction is singular, expected three independent axes; correct WholeExtent, Origin"},
           {[](hid_t f) {
              set_attribute(f, "/VTKHDF", "WholeExtent", {0, -6, 0, 6, 0, 5});
            },
            "/VTKHDF: grid: -5 voxels on axis 0, expected 1 to 2^30; correct WholeExtent"},
           {[](hid_t f) {
              set_attribute(f, "/VTKHDF", "WholeExtent", {0, 1e18, 0, 6, 0, 5});
            },
            "attribute WholeExtent holds 1000000000000000000.000000, expected whole numbers"},
           {[](hid_t f) {
              set_attribute(f, "/VTKHDF", "Version", {3, 0});
            },
            "/VTKHDF: Version is [3,0], expected [1,x] or [2,x]; write the file in one of these"},
           {[&](hid_t f) {
              set_dataset(f, array, f32, {8, 10, 11});
            },
            "/VTKHDF/PointData/density: has shape [8][10][11], expected [8][10][12] ([z][y][x])"},
           {[&](hid_t f) { set_dataset(f, array, f32, {960}); },
            "density: has shape [960], expected [8][10][12] ([z][y][x]), optionally with compon"},
           {[&](hid_t f) {
              set_dataset(f, array, f32, {8, 10, 12, 10});
            },
            "/VTKHDF/PointData/density: has 10 components, expected 1 to 9"},
           {[&](hid_t f) {
              set_dataset(f, array, H5T_C_S1, {8, 10, 12});
            },
            "bad.vtkhdf: /VTKHDF/PointData: holds no array of numbers"},
           {[&](hid_t f) {
              H5Ldelete(f, array, H5P_DEFAULT);
              H5Lcreate_soft("/gone", f, array, H5P_DEFAULT, H5P_DEFAULT);
            },
            "density: is a link to '/gone', which is not there or cannot be opened; put it there"},
           {[&](hid_t f) {
              H5Ldelete(f, array, H5P_DEFAULT);
              H5Lcreate_external("gone.h5", "/a", f, array, H5P_DEFAULT, H5P_DEFAULT);
            },
            "density: is a link to '/a' in the file 'gone.h5', which is not there or cannot be"},
           {[](hid_t f) { set_dataset(f, "/VTKHDF/PointData", H5T_IEEE_F32LE, {3}); },
            "bad.vtkhdf: /VTKHDF/PointData: missing group"}}) {
    make_bad(scene / "volume.vtkhdf", scene / "bad.vtkhdf", bad);
    expect_refused_line(scene, {"warp", "bad.vtkhdf", "mesh.vtkhdf", "-o", "out.nii"}, bad.phrase);
  }
}

TEST(BadLayouts, MeshesNameTheDataset) {
  const Scene scene;
  const hid_t i64 = H5T_STD_I64LE;
  for (const BadLayout& bad : std::vector<BadLayout>{
           {[](hid_t f) {
              set_dataset(f, "/VTKHDF/Points", H5T_IEEE_F64LE, {8, 2});
            },
            "bad.vtkhdf: /VTKHDF/Points: expected shape [n][3]"},
           {[&](hid_t f) { set_dataset(f, "/VTKHDF/NumberOfPoints", i64, {1}, {-5}); },
            "rows 0 to 0 + -5 are needed, there are 8; correct the counts and the offsets under"},
           {[&](hid_t f) { set_dataset(f, "/VTKHDF/NumberOfCells", i64, {1}, {0x1p60}); },
            "/VTKHDF/Types: rows 0 to 0 + 1152921504606846976 are needed, there are 5; correct"},
           {[](hid_t f) { set_dataset(f, "/VTKHDF/Connectivity", H5T_IEEE_F64LE, {20}); },
            "/VTKHDF/Connectivity: expected integers of shape [n]"},
           {[](hid_t f) { set_attribute(f, "/VTKHDF/Steps", "NSteps", {-1}); },
            "/VTKHDF/Steps: NSteps is -1, Values has 4 entries; expected 1 to that many"},
           {[](hid_t f) {
              set_dataset(f, "/VTKHDF/Steps/Values", H5T_IEEE_F64LE, {4}, {0, 1, not_a_number, 3});
            },
            "/VTKHDF/Steps/Values: the time of step 2 is nan, expected a finite number; correct"},
           {[&](hid_t f) {
              const char* const offsets = "/VTKHDF/Steps/PointDataOffsets/displacement";
              set_dataset(f, offsets, i64, {4}, {0, 8, 16, 1e9});
            },
            "displacement: rows 1000000000 to 1000000000 + 8 are needed, there are 32; correct"}}) {
    make_bad(scene / "mesh.vtkhdf", scene / "bad.vtkhdf", bad);
    expect_refused_line(
        scene, {"warp", "volume.vtkhdf", "bad.vtkhdf", "-o", "out.nii", "--temporal"}, bad.phrase);
  }
}

/// Warnings become errors by --strict, so that they are seen here.
TEST(BadLayouts, WhatIsValidButSeldomMeantIsToldOnce) {
  const Scene scene;
  make_bad(scene / "mesh.vtkhdf", scene / "still.vtkhdf",
           {[](hid_t f) {
              H5Lmove(f, "/VTKHDF/PointData/displacement", f, "/VTKHDF/PointData/u", H5P_DEFAULT,
                      H5P_DEFAULT);
            },
            ""});
  make_bad(scene / "mesh.vtkhdf", scene / "back.vtkhdf",
           {[](hid_t f) {
              set_dataset(f, "/VTKHDF/Steps/Values", H5T_IEEE_F64LE, {4}, {0, 2, 1, 3});
            },
            ""});
  const auto warp = [](const std::string& mesh) {
    return Names{"warp", "volume.vtkhdf", mesh, "-o", "out.vtkhdf", "--temporal", "--strict"};
  };

  expect_refused_line(scene, warp("still.vtkhdf"),
                      "still.vtkhdf: the mesh has no point array 'displacement', no points that");
  expect_refused_line(scene, warp("back.vtkhdf"),
                      "out.vtkhdf: the times of the steps do not increase: 2 is followed by 1;");
  EXPECT_EQ(run_command(scene, warp("mesh.vtkhdf")).exit_code, 0);
}
}  // namespace
}  // namespace tetwarp::test

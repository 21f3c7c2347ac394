/// @file test_cli_field_memory.cpp
/// Warps by fields with --memory: the arrays of the whole, for every format of a field.
#include <gtest/gtest.h>
#include <hdf5.h>

#include <algorithm>
#include <cmath>
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

void write_dataset(
    hid_t group, const char* name, hid_t type, const std::vector<hsize_t>& dims, const void* data) {
  const hid_t space = dims.empty() ? H5Screate(H5S_SCALAR)
                                   : H5Screate_simple(int(dims.size()), dims.data(), nullptr);
  const hid_t dataset = H5Dcreate2(group, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data);
  H5Dclose(dataset);
  H5Sclose(space);
}

/// A displacement field as ITK writes it, in LPS.
void write_itk_field(const std::string& path, const Grid& grid, const std::vector<float>& ras) {
  std::vector<double> parameters(ras.begin(), ras.end()), fixed;
  for (std::size_t n = 0; n < parameters.size(); ++n) {
    if (n % 3 < 2) parameters[n] = 0 - parameters[n];
  }
  for (const std::int64_t dim : grid.dims) fixed.push_back(double(dim));
  const double sign[3] = {-1, -1, 1};
  for (std::size_t axis = 0; axis < 3; ++axis) fixed.push_back(sign[axis] * grid.origin[axis]);
  fixed.insert(fixed.end(), grid.spacing.begin(), grid.spacing.end());
  for (std::size_t n = 0; n < 9; ++n) fixed.push_back(sign[n / 3] * grid.direction[n]);
  const std::string type = "DisplacementFieldTransform_double_3_3";
  const hid_t text = H5Tcopy(H5T_C_S1);
  H5Tset_size(text, type.size());
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t all = H5Gcreate2(file, "TransformGroup", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t group = H5Gcreate2(all, "0", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  write_dataset(group, "TransformType", text, {}, type.data());
  write_dataset(group, "TransformParameters", H5T_NATIVE_DOUBLE, {parameters.size()},
                parameters.data());
  write_dataset(group, "TransformFixedParameters", H5T_NATIVE_DOUBLE, {fixed.size()}, fixed.data());
  H5Gclose(group);
  H5Gclose(all);
  H5Fclose(file);
  H5Tclose(text);
}

/// 120 x 112 x 104 voxels of two arrays, 5.6 and 2.8 MB, and a smooth field of 16.8 MB.
class FieldMemory : public testing::Test {
 protected:
  FieldMemory() {
    Volume density = scenes::wavy_volume(grid, PixelType::float32);
    Volume labels = scenes::wavy_volume(grid, PixelType::int16);
    density.name = "density";
    labels.name = "labels";
    write_volumes(folder / "volume.vtkhdf", {&density, &labels});
    Volume field = make_volume(grid, PixelType::float32, 3, "tetwarp_displacement");
    const auto vectors = field.samples<float>();
    for (std::size_t n = 0; n < vectors.size(); ++n) {
      const auto v = static_cast<double>(n / 3);
      vectors[n] =
          static_cast<float>(4 * std::sin(v / 9) + 3 * std::sin(v / 30000 + double(n % 3)));
    }
    write_volumes(folder / "field.vtkhdf", {&field});
    Volume wide = make_volume(grid, PixelType::float64, 3, field.name);
    std::ranges::copy(vectors, wide.samples<double>().begin());
    write_volumes(folder / "wide.vtkhdf", {&wide});
    write_itk_field(folder / "field.h5", grid, {vectors.begin(), vectors.end()});
  }

  CommandResult warp(const std::string& field, const Names& more) const {
    Names words{"warp", "volume.vtkhdf", field, "--threads", "2"};
    words.insert(words.end(), more.begin(), more.end());
    return run_command(folder, words);
  }
  bool are_same(const std::string& a, const std::string& b) const {
    return std::ranges::all_of(Names{"density", "labels"}, [&](const std::string& array) {
      return read_volume(folder / a, array).data == read_volume(folder / b, array).data;
    });
  }

  const Grid grid = scenes::oblique_grid(120, 112, 104);
  const std::string limit = "56M";
  TemporaryFolder folder;
};

TEST_F(FieldMemory, GivesTheSameArraysInParts) {
  for (const char* output : {"field.nii.gz", "field.nrrd"}) {
    EXPECT_EQ(run_command(folder, {"export", "field.vtkhdf", "-o", output}).exit_code, 0);
  }
  for (const char* field :
       {"field.vtkhdf", "wide.vtkhdf", "field.h5", "field.nii.gz", "field.nrrd"}) {
    const CommandResult result =
        warp(field, {"-o", "parts.vtkhdf", "--memory", limit, "--report", "report.json"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(warp(field, {"-o", "whole.vtkhdf"}).exit_code, 0);
    EXPECT_LE(result.peak_memory, 1.02 * 56 * (1 << 20)) << field;
    EXPECT_GT(Json::parse(text_of(folder / "report.json"))["counts"]["blocks"], 1) << field;
    EXPECT_TRUE(are_same("parts.vtkhdf", "whole.vtkhdf")) << field;
  }
}

TEST_F(FieldMemory, StatesPartsAndRefusesWhatDoesNotFit) {
  const CommandResult plan =
      warp("field.vtkhdf", {"-o", "a.vtkhdf", "--memory", limit, "--dry-run"});
  EXPECT_EQ(plan.exit_code, 0) << plan.err;
  EXPECT_NE(plan.out.find(" blocks of up to "), std::string::npos) << plan.out;
  const CommandResult low = warp("field.vtkhdf", {"-o", "a.vtkhdf", "--memory", "20M"});
  EXPECT_EQ(low.exit_code, 1);
  EXPECT_TRUE(low.has_one_line_error()) << low.err;
  EXPECT_NE(low.err.find("--memory is too low"), std::string::npos) << low.err;
  const CommandResult spline =
      warp("field.vtkhdf", {"-o", "a.vtkhdf", "--memory", limit, "--filter", "bspline"});
  EXPECT_EQ(spline.exit_code, 1);
  EXPECT_NE(
      spline.err.find("bspline needs the whole source; use --filter cubic, or give --memory "),
      std::string::npos)
      << spline.err;
  EXPECT_FALSE(fs::exists(folder / "a.vtkhdf"));
}
}  // namespace
}  // namespace tetwarp::test

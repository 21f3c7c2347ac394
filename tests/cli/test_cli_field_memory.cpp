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

  /// image.nii, and a warp field of FSL that shifts it by voxels.
  void write_fsl_inputs() const {
    const Volume image = read_volume(folder / "volume.vtkhdf", "density");
    write_nifti(folder / "image.nii", image);
    ArrayHeader header{"values", PixelType::float32, 1, default_nifti_facts(1)};
    header.nifti->intent_code = 2006;
    BlockVolumeWriter writer(folder / "fsl.nii.gz", grid, {header}, {.compress = 1}, true);
    std::vector<float> shift(image.samples<float>().size());
    for (int axis = 0; axis < 3; ++axis) {
      for (std::size_t n = 0; n < shift.size(); ++n) {
        shift[n] = static_cast<float>(axis + std::sin(static_cast<double>(n) / 30000));
      }
      writer.begin_step(axis);
      writer.write(0, {{0, 0, 0}, grid.dims}, shift.data());
    }
    writer.finish();
  }

  CommandResult warp(const std::string& field,
                     const Names& more,
                     const std::string& volume = "volume.vtkhdf") const {
    Names words{"warp", volume, field, "--threads", "2"};
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

/// Only parts unpack fields: the dry run counts them, and nothing of them stays.
TEST_F(FieldMemory, UnpacksFieldsOnlyForParts) {
  write_fsl_inputs();
  EXPECT_EQ(run_command(folder, {"export", "field.vtkhdf", "-o", "field.nii.gz"}).exit_code, 0);
  const auto output_bytes = static_cast<double>(4 * grid.voxel_count());
  const double field_bytes = 3 * output_bytes;
  for (const char* field : {"field.nii.gz", "fsl.nii.gz"}) {
    const Names before = folder.names();
    const auto planned = [&](const Names& more, const std::string& output = "a.vtkhdf") {
      Names words{"-o", output, "--dry-run", "--report", "plan.json"};
      words.insert(words.end(), more.begin(), more.end());
      const CommandResult result = warp(field, words, "image.nii");
      EXPECT_EQ(result.exit_code, 0) << result.err;
      const Json plans = Json::parse(text_of(folder / "plan.json"))["plans"];
      fs::remove(folder / "plan.json");
      return plans[0]["disk"].get<double>();
    };
    EXPECT_EQ(planned({}), 0);
    EXPECT_EQ(planned({"--memory", limit}), field_bytes);
    EXPECT_EQ(planned({"--memory", "48M"}, "a.nii"), field_bytes + output_bytes);
    EXPECT_EQ(planned({"--compress", "1"}, "a.nrrd"), output_bytes);
    EXPECT_EQ(planned({}, "a.mgz"), output_bytes);
    EXPECT_EQ(folder.names(), before);
    EXPECT_EQ(warp(field, {"-o", "parts.nii", "--memory", limit}, "image.nii").exit_code, 0);
    // Whole fields need no temporary folder.
    const CommandResult whole =
        run_command(folder, {"warp", "image.nii", field, "-o", "whole.nii"},
                    {.launcher = {"/usr/bin/env", "TMPDIR=/dev/null/none"}});
    EXPECT_EQ(whole.exit_code, 0) << whole.err;
    EXPECT_TRUE(text_of(folder / "parts.nii") == text_of(folder / "whole.nii")) << field;
    EXPECT_TRUE(fs::remove(folder / "parts.nii") && fs::remove(folder / "whole.nii"));
    EXPECT_EQ(folder.names(), before);
  }
}

/// A field in one chunk, which is inflated as a whole.
TEST_F(FieldMemory, CountsTheChunksOfFields) {
  const Volume field = read_volume(folder / "field.vtkhdf");
  const hid_t file = H5Fopen((folder / "field.vtkhdf").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const char* const path = "/VTKHDF/PointData/tetwarp_displacement";
  const hsize_t dims[] = {104, 112, 120, 3};
  const hid_t space = H5Screate_simple(4, dims, nullptr);
  const hid_t layout = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(layout, 4, dims);
  H5Pset_deflate(layout, 1);
  H5Ldelete(file, path, H5P_DEFAULT);
  const hid_t data =
      H5Dcreate2(file, path, H5T_IEEE_F32LE, space, H5P_DEFAULT, layout, H5P_DEFAULT);
  H5Dwrite(data, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, field.data.data());
  H5Dclose(data);
  H5Pclose(layout);
  H5Sclose(space);
  H5Fclose(file);

  const CommandResult low = warp("field.vtkhdf", {"-o", "a.vtkhdf", "--memory", "20M"});
  const std::string marker = "give at least ";
  ASSERT_NE(low.err.find(marker), std::string::npos) << low.err;
  const int least = std::stoi(low.err.substr(low.err.find(marker) + marker.size()));
  const CommandResult result =
      warp("field.vtkhdf", {"-o", "a.vtkhdf", "--memory", std::to_string(least) + "M"});

  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_LE(result.peak_memory, 1.02 * least * (1 << 20));
}

/// A dry run of a series states every step, each as the others: all are read through the same
/// windows.
TEST_F(FieldMemory, PlansEveryStepOfASeries) {
  TemporalVolumeWriter series(folder / "series.vtkhdf");
  const Volume density = read_volume(folder / "volume.vtkhdf", "density");
  for (const double time : {0.0, 1.0, 2.0}) series.append(time, {&density});
  series.finish();

  const CommandResult result = warp(
      "field.vtkhdf", {"-o", "a.vtkhdf", "--memory", limit, "--dry-run", "--report", "plan.json"},
      "series.vtkhdf");

  EXPECT_EQ(result.exit_code, 0) << result.err;
  Json plans = Json::parse(text_of(folder / "plan.json"))["plans"];
  ASSERT_EQ(plans.size(), 3U);
  EXPECT_GT(plans[0]["blocks"], 1);
  for (int step = 0; step < 3; ++step) {
    EXPECT_EQ(plans[step]["step"], step);
    plans[step]["step"] = 0;
    EXPECT_EQ(plans[step], plans[0]);
  }
}

/// Numbers of a field that are not finite are named.
TEST(FieldFile, NamesANumberOfItksThatIsNotFinite) {
  const Scene scene;
  const Grid grid = scenes::oblique_grid(8, 7, 6);
  std::vector<float> numbers(static_cast<std::size_t>(3 * grid.voxel_count()), 0.5F);
  numbers[701] = std::nanf("");
  write_itk_field(scene / "bad.h5", grid, numbers);

  const CommandResult result =
      run_command(scene, {"warp", "volume.vtkhdf", "bad.h5", "-o", "a.vtkhdf"});

  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(result.has_one_line_error()) << result.err;
  EXPECT_NE(result.err.find("bad.h5: /TransformGroup/0/TransformParameters[701]: is not a number"),
            std::string::npos)
      << result.err;
  EXPECT_FALSE(fs::exists(scene / "a.vtkhdf"));
}

/// By a field, with --dry-run, too, and by a mesh.
TEST(FieldFile, RefusesWhatTheDiskHasNoRoomFor) {
  const Scene scene;
  const Grid grid = ramp_volume<float>().grid;
  write_itk_field(scene / "field.h5", grid,
                  std::vector<float>(3 * ramp_volume<float>().samples<float>().size()));
  write_mesh(scene / "bent.vtkhdf", box_mesh(), shifts({1}), {0});
  const Names before = scene.names();
  for (const Names& more : {Names{"field.h5"}, {"field.h5", "--dry-run"}, {"bent.vtkhdf"}}) {
    Names words{"warp", "volume.vtkhdf"};
    words.insert(words.end(), more.begin(), more.end());
    words.insert(words.end(), {"-o", "a.nii.gz", "--memory", "200M", "--dims", "40000,40000,40000",
                               "--spacing", "50,50,50"});
    const CommandResult result = run_command(scene, words);
    EXPECT_EQ(result.exit_code, 1) << more.front();
    EXPECT_TRUE(result.has_one_line_error()) << result.err;
    EXPECT_NE(result.err.find("a.nii.gz: temporary files beside it take 232.8 TiB of disk"),
              std::string::npos)
        << result.err;
    EXPECT_EQ(scene.names(), before);
  }
}
}  // namespace
}  // namespace tetwarp::test

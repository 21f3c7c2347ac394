/// @file test_io_axes.cpp
/// Order and signs of components, and what else NIfTI headers say: from NIfTI to VTKHDF and back.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/io_files.hpp"
#include "tests/support/nifti_files.hpp"

namespace tetwarp::test {
namespace {
constexpr std::array<short, 3> small_dims = {3, 2, 2};

/// The components of every voxel, which must be equal.
std::vector<float> components_of(const Volume& volume) {
  const auto samples = volume.samples<float>();
  const auto count = static_cast<std::size_t>(volume.components);
  for (std::size_t s = count; s < samples.size(); ++s) EXPECT_EQ(samples[s], samples[s - count]);
  return {samples.begin(), samples.begin() + volume.components};
}

nifti_1_header header_with(short intent_code, short components) {
  nifti_1_header header = float_header(small_dims, components);
  header.intent_code = intent_code;
  return header;
}

/// NIfTI has xx xy yy xz yz zz, VTK xx yy zz xy yz xz.
TEST(Axes, ASymmetricMatrixGetsVtksOrderAndNiftisAgain) {
  const ScratchFolder folder;
  const std::vector<float> stored = {11, 12, 22, 13, 23, 33};
  write_constant(folder / "a.nii", header_with(NIFTI_INTENT_SYMMATRIX, 6), stored);

  const Volume tensor = read_nifti(folder / "a.nii");
  write_nifti(folder / "b.nii", tensor, Axes::ras, read_nifti_facts(folder / "a.nii"));
  write_nifti(folder / "c.nii", tensor);

  EXPECT_EQ(components_of(tensor), (std::vector<float>{11, 22, 33, 12, 23, 13}));
  for (const char* name : {"b.nii", "c.nii"}) {
    EXPECT_EQ(components_in(folder / name, 7), stored) << name;
    EXPECT_EQ(header_in(folder / name).intent_code, NIFTI_INTENT_SYMMATRIX) << name;
  }
  EXPECT_EQ(header_in(folder / "c.nii").intent_p1, 3);
}

/// Half a turn about z: x and y of a vector, xz and yz of a tensor change their sign.
TEST(Axes, LpsTurnsVectorsAndTensorsBothWays) {
  const struct {
    short intent_code;
    std::vector<float> stored, turned;
  } cases[] = {
      {NIFTI_INTENT_VECTOR, {1, 2, 3}, {-1, -2, 3}},
      {NIFTI_INTENT_DISPVECT, {1, 2, 3}, {-1, -2, 3}},
      {NIFTI_INTENT_NONE, {1, 2, 3}, {-1, -2, 3}},
      {NIFTI_INTENT_SYMMATRIX, {11, 12, 22, 13, 23, 33}, {11, 22, 33, 12, -23, -13}},
      {NIFTI_INTENT_GENMATRIX, {1, 2, 3, 4, 5, 6, 7, 8, 9}, {1, 2, -3, 4, 5, -6, -7, -8, 9}},
  };
  for (const auto& field : cases) {
    const ScratchFolder folder;
    const auto count = static_cast<short>(field.stored.size());
    write_constant(folder / "a.nii", header_with(field.intent_code, count), field.stored);

    const Volume turned = read_nifti(folder / "a.nii", Axes::lps);
    const NiftiFacts facts = read_nifti_facts(folder / "a.nii", Axes::lps);
    write_nifti(folder / "b.nii", turned, Axes::lps, facts);

    EXPECT_EQ(components_of(turned), field.turned) << field.intent_code;
    EXPECT_EQ(facts.component_axes, Axes::lps);
    EXPECT_EQ(components_in(folder / "b.nii", 11), field.stored) << field.intent_code;
    // ITK turns displacements of the intent DISPVECT itself.
    EXPECT_EQ(header_in(folder / "b.nii").intent_code,
              field.intent_code == NIFTI_INTENT_DISPVECT ? NIFTI_INTENT_VECTOR : field.intent_code);
  }
}

TEST(Axes, TurnsScaledSamples) {
  const ScratchFolder folder;
  nifti_1_header header = header_with(NIFTI_INTENT_VECTOR, 3);
  header.scl_slope = 2;
  header.scl_inter = 1;
  write_constant(folder / "a.nii", header, {1, 2, 3});

  EXPECT_EQ(components_of(read_nifti(folder / "a.nii", Axes::lps)),
            (std::vector<float>{-3, -5, 7}));
}

TEST(Axes, LpsIsRefusedForComponentsOfNoDirection) {
  const ScratchFolder folder;
  for (const short components : {short{1}, short{2}, short{6}}) {
    write_constant(folder / "a.nii", header_with(NIFTI_INTENT_VECTOR, components),
                   std::vector<float>(static_cast<std::size_t>(components), 1));
    const std::string error = io_error([&] { read_nifti(folder / "a.nii", Axes::lps); });
    EXPECT_NE(error.find("leave it out"), std::string::npos) << error;
    EXPECT_NE(error.find(std::to_string(components) + " component"), std::string::npos) << error;
  }
}

/// NRRD and MetaImage do not say in which order six components are.
TEST(Axes, LpsIsRefusedForSymmetricTensorsOfUnknownOrder) {
  for (const std::string name : {"a.nrrd", "a.mha", "a.mhd"}) {
    const ScratchFolder folder;
    const Volume tensor = counting_volume(PixelType::float32, 6);
    ArrayHeader array{"t", tensor.type, 6, default_nifti_facts(6)};
    const auto write = [&] {
      BlockVolumeWriter writer(folder / name, tensor.grid, {array}, {}, false);
      writer.write(0, {{0, 0, 0}, tensor.grid.dims}, tensor.data.data());
      writer.finish();
    };
    array.nifti->component_axes = Axes::lps;
    EXPECT_NE(io_error(write).find("whose order this format does not say"), std::string::npos);
    EXPECT_EQ(folder.entry_count(), 0) << name;

    array.nifti->component_axes = Axes::ras;
    write();

    EXPECT_EQ(read_volume(folder / name).data, tensor.data) << name;
    const auto turned = [&] { read_volume(folder / name, {}, 0, {.axes = Axes::lps}); };
    EXPECT_NE(io_error(turned).find("whose order this format does not say"), std::string::npos);
  }
}

/// A displacement field for ITK has three floating-point numbers, in every format.
TEST(Axes, FieldsForItkOfOtherNumbersAreRefused) {
  const Grid grid{.dims = {3, 2, 2}};
  for (const std::string name : {"a.nii", "a.nrrd", "a.mha", "a.mhd"}) {
    for (const PixelType type : {PixelType::uint8, PixelType::int16, PixelType::int32,
                                 PixelType::float32, PixelType::float64}) {
      for (const int components : {1, 2, 3, 6, 9}) {
        const ScratchFolder folder;
        const Volume field = make_volume(grid, type, components, "tetwarp_displacement");
        ArrayHeader array{field.name, type, components, default_nifti_facts(components)};
        array.is_itk_field = true;
        const std::string error = message_of<IoError>([&] {
          BlockVolumeWriter writer(folder / name, grid, {array}, {}, false);
          writer.write(0, {{0, 0, 0}, grid.dims}, field.data.data());
          writer.finish();
        });
        const bool is_field = components == 3 && !is_integer(type);
        EXPECT_EQ(error.find("has three of float32 or float64") == std::string::npos, is_field)
            << name << name_of(type) << components << error;
        EXPECT_EQ(folder.entry_count() > 0, is_field) << name << name_of(type) << components;
      }
    }
  }
}

/// Images other than NIfTI are in millimeters, whatever the unit of the header that they come from.
TEST(Axes, PlacesInOtherImagesAreInMillimeters) {
  for (const std::string name : {"a.nrrd", "a.mha", "a.mhd", "a.mgh", "a.mgz"}) {
    for (const auto& [unit, millimeters] : {std::pair{NIFTI_UNITS_UNKNOWN, 1.0},
                                            {NIFTI_UNITS_METER, 1e3},
                                            {NIFTI_UNITS_MM, 1.0},
                                            {NIFTI_UNITS_MICRON, 1e-3}}) {
      for (const int form : {0, 1}) {
        const ScratchFolder folder;
        const Volume volume = counting_volume(PixelType::uint8, 1);
        ArrayHeader array{"a", volume.type, 1, default_nifti_facts(1)};
        array.nifti->xyzt_units = unit;
        array.nifti->sform_code = array.nifti->qform_code = form;
        BlockVolumeWriter writer(folder / name, volume.grid, {array}, {}, false);
        writer.write(0, {{0, 0, 0}, volume.grid.dims}, volume.data.data());
        writer.finish();

        const Grid grid = read_volume_header(folder / name).grid;

        // ITK takes a header without a form as LPS; FreeSurfer's images are RAS.
        const double sign = form == 0 && !name.starts_with("a.mg") ? -1 : 1;
        for (const Point3& index : {Point3{0, 0, 0}, {6, 4, 3}}) {
          const Point3 found = grid.world_of(index), place = volume.grid.world_of(index);
          for (std::size_t axis = 0; axis < 3; ++axis) {
            const double expected = (axis < 2 ? sign : 1) * millimeters * place[axis];
            EXPECT_NEAR(found[axis], expected, 1e-6 * std::abs(expected) + 1e-9) << name << unit;
          }
        }
      }
    }
  }
}

/// Facts of a header of an atlas: sform 4 (MNI), no qform.
nifti_1_header atlas_header() {
  nifti_1_header header = header_with(NIFTI_INTENT_DISPVECT, 3);
  header.sform_code = NIFTI_XFORM_MNI_152;
  header.srow_x[0] = -2;
  header.srow_y[1] = header.srow_z[2] = 2;
  header.srow_x[3] = 90;
  header.xyzt_units = NIFTI_UNITS_MICRON | NIFTI_UNITS_MSEC;
  header.intent_p1 = 0.5F;
  header.intent_p3 = -3;
  std::strcpy(header.intent_name, "flow");
  std::strcpy(header.descrip, "made by hand; 5 mm");
  return header;
}

TEST(Axes, AVtkhdfFileKeepsTheFactsOfTheHeader) {
  const ScratchFolder folder;
  const nifti_1_header source = atlas_header();
  write_constant(folder / "a.nii", source, {1, 2, 3});
  const Volume volume = read_nifti(folder / "a.nii");
  const ArrayHeader array{"values", volume.type, 3, read_nifti_facts(folder / "a.nii")};
  for (const bool is_temporal : {false, true}) {
    BlockVolumeWriter writer(folder / "v.vtkhdf", volume.grid, {array}, {}, is_temporal,
                             ChunkShape::rows);
    if (is_temporal) writer.begin_step(0);
    writer.write(0, {{0, 0, 0}, volume.grid.dims}, volume.data.data());
    writer.finish();

    const std::optional<NiftiFacts> facts =
        read_volume_header(folder / "v.vtkhdf").arrays.at(0).nifti;
    ASSERT_TRUE(facts);
    EXPECT_EQ(*facts, *array.nifti);
    write_nifti(folder / "b.nii", read_volume(folder / "v.vtkhdf"), Axes::ras, facts);

    const nifti_1_header back = header_in(folder / "b.nii");
    EXPECT_EQ(back.sform_code, 4);
    EXPECT_EQ(back.qform_code, 0);
    EXPECT_EQ(back.xyzt_units, source.xyzt_units);
    EXPECT_EQ(back.intent_code, NIFTI_INTENT_DISPVECT);
    EXPECT_EQ(back.intent_p1, 0.5F);
    EXPECT_EQ(back.intent_p3, -3);
    EXPECT_STREQ(back.intent_name, "flow");
    EXPECT_STREQ(back.descrip, source.descrip);
    EXPECT_TRUE(std::equal(back.srow_x, back.srow_x + 12, source.srow_x));
  }
}

TEST(Axes, AnUncodedHeaderStaysUncodedWhereVoxelSizesHoldTheGrid) {
  const ScratchFolder folder;
  nifti_1_header header = header_with(NIFTI_INTENT_NONE, 1);
  header.pixdim[2] = 3;
  write_constant(folder / "a.nii", header, {1});
  Volume volume = read_nifti(folder / "a.nii");
  const NiftiFacts facts = read_nifti_facts(folder / "a.nii");
  write_nifti(folder / "same.nii", volume, Axes::ras, facts);
  volume.grid.origin = {5, 0, 0};
  write_nifti(folder / "moved.nii", volume, Axes::ras, facts);

  const nifti_1_header same = header_in(folder / "same.nii");
  const nifti_1_header moved = header_in(folder / "moved.nii");
  EXPECT_EQ(same.sform_code, 0);
  EXPECT_EQ(same.qform_code, 0);
  EXPECT_EQ(same.pixdim[2], 3);
  EXPECT_EQ(moved.sform_code, NIFTI_XFORM_SCANNER_ANAT);
  EXPECT_EQ(moved.qform_code, 0);
  EXPECT_EQ(read_nifti(folder / "moved.nii").grid, volume.grid);
}

/// The qform alone holds a turned grid; a sheared one needs the sform, which takes its code.
TEST(Axes, AQformStaysAloneUntilAGridIsSheared) {
  const ScratchFolder folder;
  nifti_1_header header = header_with(NIFTI_INTENT_NONE, 1);
  header.qform_code = NIFTI_XFORM_ALIGNED_ANAT;
  header.quatern_d = 1;  // half a turn about z
  header.qoffset_x = 7;
  write_constant(folder / "a.nii", header, {1});
  Volume volume = read_nifti(folder / "a.nii");
  const NiftiFacts facts = read_nifti_facts(folder / "a.nii");
  write_nifti(folder / "b.nii", volume, Axes::ras, facts);
  const Grid back = read_nifti(folder / "b.nii").grid;
  volume.grid.direction[1] = 0.5;
  write_nifti(folder / "c.nii", volume, Axes::ras, facts);

  EXPECT_EQ(header_in(folder / "b.nii").sform_code, 0);
  EXPECT_EQ(header_in(folder / "b.nii").qform_code, NIFTI_XFORM_ALIGNED_ANAT);
  EXPECT_NEAR(back.direction[0], -1, 1e-6);
  EXPECT_EQ(back.origin, (Point3{7, 0, 0}));
  EXPECT_EQ(header_in(folder / "c.nii").sform_code, NIFTI_XFORM_ALIGNED_ANAT);
  EXPECT_EQ(header_in(folder / "c.nii").qform_code, 0);
}

/// Written again, the code of the qform would claim the sform's grid for another space.
TEST(Axes, AQformThatDiffersFromTheSformIsNotCodedAgain) {
  const ScratchFolder folder;
  nifti_1_header header = atlas_header();
  header.qform_code = NIFTI_XFORM_SCANNER_ANAT;
  header.qoffset_x = 20;
  write_constant(folder / "a.nii", header, {1, 2, 3});

  EXPECT_EQ(read_nifti_facts(folder / "a.nii").qform_code, 0);
  EXPECT_EQ(read_nifti_facts(folder / "a.nii").sform_code, NIFTI_XFORM_MNI_152);
}

/// Writes one array with these facts. @returns the error, empty without one
std::string error_of_writing(const std::string& path, const NiftiFacts& facts) {
  const Volume volume = make_volume(oblique_grid(), PixelType::float32);
  return io_error([&] {
    const ArrayHeader array{"values", PixelType::float32, 1, facts};
    BlockVolumeWriter writer(path, volume.grid, {array}, {}, false, ChunkShape::rows);
    writer.write(0, {{0, 0, 0}, volume.grid.dims}, volume.data.data());
    writer.finish();
  });
}

TEST(Axes, ReadersRefuseFactsThatNiftiCannotHold) {
  const ScratchFolder folder;
  const std::string file = folder / "v.vtkhdf", values = "VTKHDF/PointData/values";
  const auto error = [&] { return io_error([&] { read_volume_header(file); }); };

  EXPECT_EQ(error_of_writing(file, {}), "");
  EXPECT_EQ(error(), "");
  Hdf5Editor(file).attribute<std::int64_t>(values, "tetwarp_nifti_sform_code", {40000});
  EXPECT_NE(error().find("values: attribute tetwarp_nifti_sform_code is 40000"), std::string::npos);
  Hdf5Editor(file).attribute<std::int64_t>(values, "tetwarp_nifti_sform_code", {1});
  Hdf5Editor(file).text(values, "tetwarp_nifti_descrip", std::string(200, 'x'));
  EXPECT_NE(error().find("tetwarp_nifti_descrip has 200 bytes"), std::string::npos);
}

TEST(Axes, WritersRefuseFactsThatNiftiCannotHold) {
  const ScratchFolder folder;
  const std::vector<std::pair<NiftiFacts, std::string>> wrong = {
      {{.sform_code = 40000}, "sform_code is 40000, expected 0 to 32767"},
      {{.qform_code = -1}, "qform_code is -1"},
      {{.xyzt_units = 256}, "xyzt_units is 256, expected 0 to 255"},
      {{.intent_code = 40000}, "intent_code is 40000"},
      {{.intent_name = std::string(17, 'x')}, "intent_name has 17 bytes, expected at most 16"},
      {{.description = std::string(81, 'x')}, "description has 81 bytes, expected at most 80"},
      {{.cal_min = std::numeric_limits<double>::quiet_NaN()}, "cal_min is no finite number"},
      {{.cal_max = 1e39}, "cal_max is no finite number of 32 bits"},
      {{.time_step = std::numeric_limits<double>::infinity()}, "time_step is no finite number"},
      {{.intent_p = {3, 1e39, 0}}, "intent_p[1] is no finite number of 32 bits"}};
  for (const char* const name : {"v.vtkhdf", "v.nii"}) {
    for (const auto& [facts, text] : wrong) {
      const std::string error = error_of_writing(folder / name, facts);
      EXPECT_NE(error.find("NIfTI header: " + text), std::string::npos) << name << ": " << error;
      EXPECT_FALSE(std::filesystem::exists(folder / name)) << text;
    }
  }
}
}  // namespace
}  // namespace tetwarp::test

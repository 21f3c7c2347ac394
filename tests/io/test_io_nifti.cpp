#include <gtest/gtest.h>
#include <nifti1.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <string>

#include "tests/support/io_files.hpp"
#include "tests/support/nifti_files.hpp"

namespace tetwarp::test {
namespace {
/// A header of a 2 x 3 x 2 int16 volume with unit voxels.
nifti_1_header plain_header() {
  nifti_1_header header = float_header({2, 3, 2}, 1);
  header.dim[0] = 3;
  header.datatype = DT_INT16;
  header.bitpix = 16;
  return header;
}

/// The header, four empty bytes and twelve samples 0, 1, 2...
void write_file(const std::string& path, const nifti_1_header& header, std::int16_t samples = 12) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(&header), sizeof header);
  file.write("\0\0\0\0", 4);
  for (std::int16_t sample = 0; sample < samples; ++sample) {
    file.write(reinterpret_cast<const char*>(&sample), sizeof sample);
  }
}

TEST(Nifti, RoundTripsEveryTypeAndComponentCountBitForBit) {
  const ScratchFolder folder;
  for (int type = 0; type < 10; ++type) {
    for (const int components : {1, 3}) {
      for (const char* name : {"v.nii", "v.nii.gz"}) {
        const Volume volume = counting_volume(static_cast<PixelType>(type), components);

        write_nifti(folder / name, volume);
        const Volume back = read_nifti(folder / name);

        EXPECT_EQ(back.type, volume.type);
        EXPECT_EQ(back.components, components);
        EXPECT_EQ(back.grid.dims, volume.grid.dims);
        EXPECT_EQ(back.data, volume.data) << name << " " << name_of(volume.type);
      }
    }
  }
}

/// The format holds the affine map in float32: 2^-24 of the largest coordinate.
TEST(Nifti, KeepsTheGridToFloatPrecision) {
  const ScratchFolder folder;
  const Volume volume = counting_volume(PixelType::uint8);
  write_nifti(folder / "v.nii", volume);

  const Grid grid = read_nifti(folder / "v.nii").grid;

  for (const Point3& index : {Point3{0, 0, 0}, {6, 0, 0}, {0, 4, 0}, {0, 0, 3}}) {
    const Point3 expected = volume.grid.world_of(index);
    const Point3 found = grid.world_of(index);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(found[axis], expected[axis], 0x1p-23 * std::abs(expected[axis]) + 1e-6);
    }
  }
}

TEST(Nifti, WritesTheSameAffineMapAgain) {
  const ScratchFolder folder;
  write_nifti(folder / "a.nii", counting_volume(PixelType::uint8));
  const Volume once = read_nifti(folder / "a.nii");
  write_nifti(folder / "b.nii", once);

  EXPECT_EQ(read_nifti(folder / "b.nii").grid, once.grid);
}

TEST(Nifti, WritesBothFormsOfARotationAndTheSformAloneOfAShear) {
  const ScratchFolder folder;
  Volume volume = counting_volume(PixelType::uint8);
  write_nifti(folder / "a.nii", volume);
  volume.grid.direction = {1, 0.5, 0, 0, 1, 0, 0, 0, 1};
  write_nifti(folder / "b.nii", volume);

  EXPECT_GT(header_in(folder / "a.nii").qform_code, 0);
  EXPECT_EQ(header_in(folder / "b.nii").qform_code, 0);
  EXPECT_GT(header_in(folder / "b.nii").sform_code, 0);
  const Grid back = read_nifti(folder / "b.nii").grid;
  EXPECT_NEAR(back.direction[1] * back.spacing[1], 0.5 * volume.grid.spacing[1], 1e-6);
}

TEST(Nifti, PrefersSformThenQformThenVoxelSizes) {
  const ScratchFolder folder;
  nifti_1_header header = plain_header();
  header.pixdim[1] = 3;
  write_file(folder / "v.nii", header);
  EXPECT_EQ(read_nifti(folder / "v.nii").grid.spacing, (Point3{3, 1, 1}));

  header.qform_code = 1;
  header.qoffset_y = -7;
  write_file(folder / "v.nii", header);
  EXPECT_EQ(read_nifti(folder / "v.nii").grid.origin, (Point3{0, -7, 0}));

  header.sform_code = 1;
  header.srow_x[0] = header.srow_y[2] = header.srow_z[1] = -2;
  header.srow_z[3] = 9;
  write_file(folder / "v.nii", header);
  const Grid grid = read_nifti(folder / "v.nii").grid;
  EXPECT_EQ(grid.origin, (Point3{0, 0, 9}));
  EXPECT_EQ(grid.spacing, (Point3{2, 2, 2}));
  EXPECT_EQ(grid.direction, (std::array<double, 9>{-1, 0, 0, 0, 0, -1, 0, -1, 0}));
}

TEST(Nifti, ScalesSamplesToFloat32) {
  const ScratchFolder folder;
  nifti_1_header header = plain_header();
  header.scl_slope = 0.5F;
  header.scl_inter = -1;
  write_file(folder / "v.nii", header);

  const Volume volume = read_nifti(folder / "v.nii");

  EXPECT_EQ(volume.type, PixelType::float32);
  EXPECT_EQ(volume.samples<float>()[11], 4.5F);
}

TEST(Nifti, KeepsSamplesUnderTheIdentityScaling) {
  const ScratchFolder folder;
  nifti_1_header header = plain_header();
  header.scl_slope = 1;
  write_file(folder / "v.nii", header);

  const Volume volume = read_nifti(folder / "v.nii");

  EXPECT_EQ(volume.type, PixelType::int16);
  EXPECT_EQ(volume.samples<std::int16_t>()[11], 11);
}

TEST(Nifti, ReadsTheOtherByteOrder) {
  const ScratchFolder folder;
  write_nifti(folder / "v.nii", counting_volume(PixelType::int16));
  const Volume expected = read_nifti(folder / "v.nii");
  std::fstream file(folder / "v.nii", std::ios::in | std::ios::out | std::ios::binary);
  std::string bytes(std::istreambuf_iterator<char>(file), {});
  const auto swap = [&](std::size_t begin, std::size_t end, std::size_t size) {
    for (std::size_t at = begin; at < end; at += size) {
      std::reverse(bytes.data() + at, bytes.data() + at + size);
    }
  };
  swap(0, 4, 4);
  swap(40, 56, 2);
  swap(68, 76, 2);
  swap(76, 120, 4);
  swap(252, 256, 2);
  swap(256, 328, 4);
  swap(352, bytes.size(), 2);
  file.seekp(0);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();

  const Volume volume = read_nifti(folder / "v.nii");

  EXPECT_EQ(volume.grid, expected.grid);
  EXPECT_EQ(volume.data, expected.data);
}

/// RAS as the grid is, LPS as ITK takes the vectors of an image.
TEST(Nifti, TurnsDisplacementsForItkAndRefusesOtherSamples) {
  const ScratchFolder folder;
  for (const PixelType type : {PixelType::float32, PixelType::float64}) {
    Volume volume = make_volume(oblique_grid(), type, 3);
    std::vector<double> expected;
    for (std::size_t s = 0; s < 3 * 7 * 5 * 4; ++s) {
      const double value = static_cast<double>(s % 11) - 4;
      type == PixelType::float32 ? volume.samples<float>()[s] = static_cast<float>(value)
                                 : volume.samples<double>()[s] = value;
      expected.push_back(s % 3 == 2 ? value : -value);
    }

    write_nifti(folder / "v.nii", volume, Axes::lps);

    const nifti_1_header header = header_in(folder / "v.nii");
    EXPECT_EQ(header.intent_code, NIFTI_INTENT_VECTOR);
    EXPECT_EQ(header.dim[0], 5);
    EXPECT_EQ(header.dim[5], 3);
    const Volume back = read_nifti(folder / "v.nii");
    for (std::size_t s = 0; s < expected.size(); ++s) {
      const double value =
          type == PixelType::float32 ? back.samples<float>()[s] : back.samples<double>()[s];
      ASSERT_EQ(value, expected[s]) << s;
    }
  }
  for (const Volume& other :
       {counting_volume(PixelType::float32, 2), counting_volume(PixelType::int16, 3)}) {
    const std::string error = io_error([&] { write_nifti(folder / "w.nii", other, Axes::lps); });
    EXPECT_NE(error.find("vectors (3), tensors (9)"), std::string::npos) << error;
  }
}

TEST(Nifti, KeepsNaN) {
  const ScratchFolder folder;
  Volume volume = counting_volume(PixelType::float32);
  volume.samples<float>()[5] = std::numeric_limits<float>::quiet_NaN();
  write_nifti(folder / "v.nii.gz", volume);

  EXPECT_EQ(read_nifti(folder / "v.nii.gz").data, volume.data);
}

TEST(Nifti, HoldsASingleSlice) {
  const ScratchFolder folder;
  Grid grid;
  grid.dims = {4, 3, 1};
  write_nifti(folder / "v.nii", make_volume(grid, PixelType::uint8));

  EXPECT_EQ(read_nifti(folder / "v.nii").grid, grid);
}

TEST(Nifti, RefusesDamagedFilesByNamingTheField) {
  const ScratchFolder folder;
  const auto error = [&](const nifti_1_header& header, std::int16_t samples = 12) {
    write_file(folder / "v.nii", header, samples);
    return io_error([&] { read_nifti(folder / "v.nii"); });
  };
  nifti_1_header times = plain_header();
  times.dim[0] = 4;
  times.dim[4] = 20;
  nifti_1_header bits = plain_header();
  bits.bitpix = 8;
  nifti_1_header negative = plain_header();
  negative.dim[2] = -3;
  nifti_1_header huge = plain_header();
  huge.dim[1] = huge.dim[2] = huge.dim[3] = 32767;
  nifti_1_header color = plain_header();
  color.datatype = DT_RGB24;
  nifti_1_header singular = plain_header();
  singular.sform_code = 1;
  nifti_1_header offset = plain_header();
  offset.vox_offset = std::numeric_limits<float>::quiet_NaN();

  EXPECT_NE(error(times).find("truncated"), std::string::npos) << error(times);
  EXPECT_NE(error(bits).find("bitpix: is 8"), std::string::npos) << error(bits);
  EXPECT_NE(error(negative).find("dim[2]: is -3"), std::string::npos) << error(negative);
  EXPECT_NE(error(huge).find("truncated"), std::string::npos) << error(huge);
  EXPECT_NE(error(color).find("but colors have 24"), std::string::npos) << error(color);
  EXPECT_NE(error(singular).find("sform"), std::string::npos) << error(singular);
  EXPECT_NE(error(offset).find("vox_offset: is nan"), std::string::npos) << error(offset);
  EXPECT_NE(error(plain_header(), 11).find("truncated"), std::string::npos);
}

/// Colors lie voxel by voxel in the file, and plane by plane when they are written as components.
TEST(Nifti, ColorsAreComponents) {
  for (const int bytes : {3, 4}) {
    const ScratchFolder folder;
    nifti_1_header header = float_header({5, 3, 2}, 1);
    header.datatype = bytes == 3 ? DT_RGB24 : DT_RGBA32;
    header.bitpix = static_cast<short>(8 * bytes);
    header.dim[0] = 4;
    header.dim[4] = 2;  // steps
    std::string samples;
    for (int n = 0; n < 60 * bytes; ++n) samples += static_cast<char>(n % 251);
    std::ofstream(folder / "c.nii", std::ios::binary)
        << std::string(reinterpret_cast<const char*>(&header), sizeof header)
        << std::string(4, '\0') << samples;

    const Volume second = read_volume(folder / "c.nii", {}, 1);

    EXPECT_EQ(second.components, bytes);
    EXPECT_EQ(second.type, PixelType::uint8);
    for (std::size_t s = 0; s < second.data.size(); ++s) {
      const auto n = s + static_cast<std::size_t>(30 * bytes);
      ASSERT_EQ(second.data[s], static_cast<std::byte>(n % 251));
    }
    std::vector<std::uint8_t> voxel(static_cast<std::size_t>(bytes));
    VolumeReader(folder / "c.nii", {}, 1).read({{4, 2, 1}, {5, 3, 2}}, voxel.data());
    EXPECT_EQ(voxel.back(), static_cast<std::uint8_t>((60 * bytes - 1) % 251));
    const NiftiFacts facts = read_nifti_facts(folder / "c.nii");
    EXPECT_EQ(facts.intent_code, bytes == 3 ? 2003 : 2004);
    write_nifti(folder / "w.nii.gz", second, Axes::ras, facts);
    EXPECT_EQ(read_nifti(folder / "w.nii.gz").data, second.data);
    EXPECT_EQ(read_nifti_facts(folder / "w.nii.gz").intent_code, facts.intent_code);
  }
}

TEST(Nifti, RefusesNamesOfOtherFormats) {
  const ScratchFolder folder;
  const Volume volume = counting_volume(PixelType::uint8);

  EXPECT_THROW(write_nifti(folder / "v.vtkhdf", volume), IoError);
  EXPECT_EQ(folder.entry_count(), 0);
}

TEST(Nifti, IsRecognizedByContent) {
  const ScratchFolder folder;
  write_nifti(folder / "v.nii.gz", counting_volume(PixelType::uint8));
  std::filesystem::rename(folder / "v.nii.gz", folder / "v.vtkhdf");

  EXPECT_EQ(kind_of(folder / "v.vtkhdf"), FileKind::nifti);
  EXPECT_EQ(read_volume(folder / "v.vtkhdf").data, counting_volume(PixelType::uint8).data);
}
}  // namespace
}  // namespace tetwarp::test

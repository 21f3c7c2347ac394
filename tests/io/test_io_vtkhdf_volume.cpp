#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <numeric>

#include "tests/support/io_files.hpp"

namespace tetwarp::test {
namespace {
using Mode = Hdf5Editor::Mode;

constexpr PixelType all_types[] = {
    PixelType::uint8, PixelType::int8,   PixelType::uint16, PixelType::int16,   PixelType::uint32,
    PixelType::int32, PixelType::uint64, PixelType::int64,  PixelType::float32, PixelType::float64};

/// Bytes that a dataset takes in the file.
hsize_t stored_bytes(const std::string& path, const char* name) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t dataset = H5Dopen2(file, name, H5P_DEFAULT);
  const hsize_t bytes = H5Dget_storage_size(dataset);
  H5Dclose(dataset);
  H5Fclose(file);
  return bytes;
}

/// An image of 3 x 2 x 2 voxels as another program writes it.
void write_foreign(const std::string& path, hid_t file_type) {
  std::vector<std::int32_t> values(12);
  std::iota(values.begin(), values.end(), 100);
  Hdf5Editor(path, Mode::create)
      .group("VTKHDF")
      .group("VTKHDF/PointData")
      .text("VTKHDF", "Type", "ImageData")
      .attribute<std::int64_t>("VTKHDF", "WholeExtent", {2, 4, -1, 0, 10, 11})
      .attribute<float>("VTKHDF", "Origin", {1, 2, 3})
      .attribute<double>("VTKHDF", "Spacing", {0.5, 2, 1})
      .dataset("VTKHDF/PointData/a", {2, 2, 3}, values, file_type);
}

TEST(VtkhdfVolume, RoundTripsEveryTypeAndComponentCountBitForBit) {
  const ScratchFolder folder;
  for (const PixelType type : all_types) {
    for (const int components : {1, 3, 9}) {
      for (const int compress : {0, 4}) {
        const Volume volume = counting_volume(type, components, "a b");

        write_volumes(folder / "v.vtkhdf", {&volume}, {.compress = compress, .fingerprint = {}});
        const Volume back = read_volume(folder / "v.vtkhdf");

        EXPECT_EQ(back.grid, volume.grid);
        EXPECT_EQ(back.name, "a b");
        EXPECT_EQ(back.type, type);
        EXPECT_EQ(back.components, components);
        EXPECT_EQ(back.data, volume.data) << name_of(type) << " " << components;
      }
    }
  }
}

TEST(VtkhdfVolume, KeepsSeveralArraysInTheirOrder) {
  const ScratchFolder folder;
  const Volume second = counting_volume(PixelType::int16, 1, "second");
  const Volume first = counting_volume(PixelType::float32, 3, "first");

  write_volumes(folder / "v.vtkhdf", {&second, &first});
  const VolumeHeader header = read_volume_header(folder / "v.vtkhdf");

  ASSERT_EQ(header.arrays.size(), 2U);
  EXPECT_EQ(header.arrays[0].name, "second");
  EXPECT_EQ(header.arrays[0].type, PixelType::int16);
  EXPECT_EQ(header.arrays[1].name, "first");
  EXPECT_EQ(header.arrays[1].components, 3);
  EXPECT_TRUE(header.times.empty());
  EXPECT_EQ(read_volume(folder / "v.vtkhdf", "second").data, second.data);
}

/// The extent's start moves the origin: 1 + 0.5 * 2, 2 - 2, 3 + 10.
TEST(VtkhdfVolume, ShiftsTheOriginByTheExtentsStart) {
  const ScratchFolder folder;
  write_foreign(folder / "v.vtkhdf", H5T_STD_I32LE);

  const Volume volume = read_volume(folder / "v.vtkhdf", "a");

  EXPECT_EQ(volume.grid.dims, (std::array<std::int64_t, 3>{3, 2, 2}));
  EXPECT_EQ(volume.grid.origin, (Point3{2, 0, 13}));
  EXPECT_EQ(volume.grid.direction, (std::array<double, 9>{1, 0, 0, 0, 1, 0, 0, 0, 1}));
  EXPECT_EQ(volume.samples<std::int32_t>()[11], 111);
}

TEST(VtkhdfVolume, ReadsEitherByteOrder) {
  const ScratchFolder folder;
  for (const hid_t type : {H5T_STD_U8BE, H5T_STD_I16BE, H5T_STD_I32BE, H5T_STD_U64BE}) {
    write_foreign(folder / "v.vtkhdf", type);
    const Volume volume = read_volume(folder / "v.vtkhdf");
    EXPECT_EQ(static_cast<int>(volume.data[0]), 100);
    EXPECT_EQ(static_cast<int>(volume.data[volume.data.size() - size_of(volume.type)]), 111);
  }
  write_foreign(folder / "v.vtkhdf", H5T_IEEE_F64BE);
  EXPECT_EQ(read_volume(folder / "v.vtkhdf").samples<double>()[11], 111.0);
}

/// Labels 3 and -7 with names, in the order of bytes that is not this machine's.
TEST(VtkhdfVolume, ReadsEnumerationsAsTheirIntegers) {
  const ScratchFolder folder;
  const std::vector<std::uint8_t> bytes = {0, 3, 0xff, 0xf9};
  const auto* const labels = reinterpret_cast<const std::int16_t*>(bytes.data());
  const hid_t type = H5Tenum_create(H5T_STD_I16BE);
  H5Tenum_insert(type, "liver", labels);
  H5Tenum_insert(type, "lung", labels + 1);
  std::vector<std::int16_t> samples(12, labels[0]);
  samples[11] = labels[1];
  write_foreign(folder / "v.vtkhdf", H5T_STD_I32LE);
  Hdf5Editor(folder / "v.vtkhdf").dataset("VTKHDF/PointData/a", {2, 2, 3}, samples, type);
  H5Tclose(type);

  const Volume volume = read_volume(folder / "v.vtkhdf");

  ASSERT_EQ(volume.type, PixelType::int16);
  EXPECT_EQ(volume.samples<std::int16_t>()[0], 3);
  EXPECT_EQ(volume.samples<std::int16_t>()[11], -7);
}

TEST(VtkhdfVolume, ReadsHalfPrecisionAsFloat32) {
  const ScratchFolder folder;
  const hid_t half = H5Tcopy(H5T_IEEE_F32LE);
  H5Tset_fields(half, 15, 10, 5, 0, 10);
  H5Tset_size(half, 2);
  H5Tset_ebias(half, 15);
  write_foreign(folder / "v.vtkhdf", half);
  H5Tclose(half);

  const Volume volume = read_volume(folder / "v.vtkhdf");

  EXPECT_EQ(volume.type, PixelType::float32);
  EXPECT_EQ(volume.samples<float>()[11], 111.0F);
}

TEST(VtkhdfVolume, ReadsAFlatImageWithOrWithoutItsThirdAxis) {
  const ScratchFolder folder;
  const std::vector<std::int16_t> values = {1, 2, 3, 4, 5, 6};
  for (const std::vector<hsize_t>& dims : {std::vector<hsize_t>{1, 2, 3}, {2, 3}, {2, 3, 1}}) {
    write_foreign(folder / "v.vtkhdf", H5T_STD_I32LE);
    Hdf5Editor(folder / "v.vtkhdf")
        .attribute<std::int32_t>("VTKHDF", "WholeExtent", {0, 2, 0, 1, 0, 0})
        .dataset("VTKHDF/PointData/a", dims, values);
    EXPECT_EQ(read_volume(folder / "v.vtkhdf").samples<std::int16_t>()[5], 6);
  }
}

TEST(VtkhdfVolume, DoesNotStoreChunksOfBackground) {
  const ScratchFolder folder;
  Grid grid;
  grid.dims = {64, 64, 80};
  Volume volume = make_volume(grid, PixelType::float32);
  std::ranges::fill(volume.samples<float>(), -1024.0F);
  volume.samples<float>()[std::size_t{64} * 64 * 40] = 7;

  write_volumes(folder / "v.vtkhdf", {&volume}, {.background = -1024, .fingerprint = {}});

  EXPECT_EQ(stored_bytes(folder / "v.vtkhdf", "VTKHDF/PointData/values"), 256U << 10);
  EXPECT_EQ(read_volume(folder / "v.vtkhdf").data, volume.data);
}

TEST(VtkhdfVolume, RoundsAndSaturatesTheBackground) {
  const ScratchFolder folder;
  Volume volume = make_volume(oblique_grid(), PixelType::int8);
  std::ranges::fill(volume.samples<std::int8_t>(), std::int8_t{-128});

  write_volumes(folder / "v.vtkhdf", {&volume}, {.background = -1024, .fingerprint = {}});

  EXPECT_EQ(stored_bytes(folder / "v.vtkhdf", "VTKHDF/PointData/values"), 0U);
  EXPECT_EQ(read_volume(folder / "v.vtkhdf").data, volume.data);
}

TEST(VtkhdfVolume, KeepsNaN) {
  const ScratchFolder folder;
  Volume volume = make_volume(oblique_grid(), PixelType::float32);
  volume.samples<float>()[3] = std::numeric_limits<float>::quiet_NaN();

  write_volumes(folder / "v.vtkhdf", {&volume}, {.compress = 1, .fingerprint = {}});

  EXPECT_EQ(read_volume(folder / "v.vtkhdf").data, volume.data);
}

TEST(VtkhdfVolume, WritesTheTypeAsAsciiOfExactSize) {
  const ScratchFolder folder;
  const Volume volume = counting_volume(PixelType::uint8);
  write_volumes(folder / "v.vtkhdf", {&volume});

  const hid_t file = H5Fopen((folder / "v.vtkhdf").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t attribute = H5Aopen_by_name(file, "VTKHDF", "Type", H5P_DEFAULT, H5P_DEFAULT);
  const hid_t type = H5Aget_type(attribute);
  EXPECT_EQ(H5Tget_size(type), std::strlen("ImageData"));
  EXPECT_EQ(H5Tget_cset(type), H5T_CSET_ASCII);
  EXPECT_EQ(H5Tis_variable_str(type), 0);
  H5Tclose(type);
  H5Aclose(attribute);
  H5Fclose(file);
}

TEST(VtkhdfVolume, GivesTheSameBytesForTheSameContent) {
  const ScratchFolder folder;
  const Volume volume = counting_volume(PixelType::int16, 3);
  const auto bytes_of = [&](const std::string& path) {
    write_volumes(path, {&volume}, {.compress = 2, .fingerprint = {}});
    std::ifstream file(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };

  EXPECT_EQ(bytes_of(folder / "a.vtkhdf"), bytes_of(folder / "b.vtkhdf"));
}

TEST(VtkhdfVolume, RoundTripsATemporalFileAndStoresRepeatedStepsOnce) {
  const ScratchFolder folder;
  const Volume a = counting_volume(PixelType::int16, 1, "a");
  const Volume b = counting_volume(PixelType::float32, 3, "b");
  Volume later = a;
  std::ranges::reverse(later.data);

  TemporalVolumeWriter writer(folder / "t.vtkhdf", {.compress = 1, .fingerprint = {}});
  writer.append(0.5, {&a, &b});
  writer.repeat(0.75);
  writer.append(1.5, {&later, &b});
  EXPECT_FALSE(std::filesystem::exists(folder / "t.vtkhdf"));
  const std::int64_t bytes = writer.finish().bytes;

  EXPECT_EQ(bytes, static_cast<std::int64_t>(std::filesystem::file_size(folder / "t.vtkhdf")));
  EXPECT_EQ(read_volume_header(folder / "t.vtkhdf").times, (std::vector<double>{0.5, 0.75, 1.5}));
  EXPECT_EQ(read_volume(folder / "t.vtkhdf", "a", 0).data, a.data);
  EXPECT_EQ(read_volume(folder / "t.vtkhdf", "a", 1).data, a.data);
  EXPECT_EQ(read_volume(folder / "t.vtkhdf", "a", 2).data, later.data);
  EXPECT_EQ(read_volume(folder / "t.vtkhdf", "b", 2).data, b.data);
}

TEST(VtkhdfVolume, TakesTheStepNumberWhereATemporalFileHasNoOffsets) {
  const ScratchFolder folder;
  std::vector<std::int32_t> values(24);
  std::iota(values.begin(), values.end(), 0);
  write_foreign(folder / "t.vtkhdf", H5T_STD_I32LE);
  Hdf5Editor(folder / "t.vtkhdf")
      .dataset("VTKHDF/PointData/a", {2, 2, 2, 3}, values)
      .group("VTKHDF/Steps")
      .attribute<std::int32_t>("VTKHDF/Steps", "NSteps", {2})
      .dataset<double>("VTKHDF/Steps/Values", {2}, {0, 1});

  EXPECT_EQ(read_volume(folder / "t.vtkhdf", "a", 1).samples<std::int32_t>()[0], 12);
}

TEST(VtkhdfVolume, LeavesNothingOfATemporalFileThatWasNotFinished) {
  const ScratchFolder folder;
  const Volume volume = counting_volume(PixelType::uint8);
  {
    TemporalVolumeWriter writer(folder / "t.vtkhdf");
    writer.append(0, {&volume});
  }
  EXPECT_EQ(folder.entry_count(), 0);
}

TEST(VtkhdfVolume, KeepsTheFingerprint) {
  const ScratchFolder folder;
  const Volume volume = counting_volume(PixelType::uint8);
  write_volumes(folder / "a.vtkhdf", {&volume}, {.fingerprint = "0123abc"});
  write_volumes(folder / "b.vtkhdf", {&volume});

  EXPECT_EQ(read_fingerprint(folder / "a.vtkhdf"), "0123abc");
  EXPECT_EQ(read_fingerprint(folder / "b.vtkhdf"), std::nullopt);
  EXPECT_EQ(read_fingerprint(folder / "none.vtkhdf"), std::nullopt);
}

TEST(VtkhdfVolume, IsDistinguishedFromAMeshByContent) {
  const ScratchFolder folder;
  const Volume volume = counting_volume(PixelType::uint8);
  write_volumes(folder / "v", {&volume});
  write_mesh(folder / "m", two_tets());
  std::ofstream(folder / "t") << "text";

  EXPECT_EQ(kind_of(folder / "v"), FileKind::volume);
  EXPECT_EQ(kind_of(folder / "m"), FileKind::mesh);
  EXPECT_EQ(kind_of(folder / "t"), FileKind::unknown);
  // Exodus in netCDF-4 is HDF5, too, and is recognized by its name.
  for (const std::string name : {"x.exo", "x.e", "x.h5"}) {
    H5Fclose(H5Fcreate((folder / name).c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
    EXPECT_EQ(kind_of(folder / name), name == "x.h5" ? FileKind::hdf5 : FileKind::unknown);
  }
  EXPECT_THROW(kind_of(folder / "none"), IoError);
}
}  // namespace
}  // namespace tetwarp::test

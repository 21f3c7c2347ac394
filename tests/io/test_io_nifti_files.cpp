/// @file test_io_nifti_files.cpp
/// NIfTI-2, pairs of files, series, and regions of NIfTI files.
#include <gtest/gtest.h>
#include <nifti1.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/support/io_files.hpp"
#include "tests/support/nifti_files.hpp"

namespace tetwarp::test {
namespace {
void store(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

/// A number at its place in the header of NIfTI-2.
template <class T>
void put(std::string& bytes, std::size_t at, T number) {
  std::memcpy(bytes.data() + at, &number, sizeof number);
}

/// The file as NIfTI-2, from the fields of NIfTI-1 by their offsets in both formats.
std::string as_second(const std::string& first) {
  nifti_1_header header{};
  std::memcpy(&header, first.data(), sizeof header);
  std::string bytes(544, '\0');
  put<std::int32_t>(bytes, 0, 540);
  bytes.replace(4, 8, std::string("n+2\0\r\n\032\n", 8));
  put(bytes, 12, header.datatype);
  put(bytes, 14, header.bitpix);
  for (std::size_t n = 0; n < 8; ++n) {
    put<std::int64_t>(bytes, 16 + 8 * n, header.dim[n]);
    put<double>(bytes, 104 + 8 * n, header.pixdim[n]);
  }
  put<std::int64_t>(bytes, 168, 544);
  put<double>(bytes, 176, header.scl_slope);
  put<double>(bytes, 184, header.scl_inter);
  bytes.replace(240, sizeof header.descrip, header.descrip, sizeof header.descrip);
  put<std::int32_t>(bytes, 344, header.qform_code);
  put<std::int32_t>(bytes, 348, header.sform_code);
  const float quaternion[] = {header.quatern_b, header.quatern_c, header.quatern_d,
                              header.qoffset_x, header.qoffset_y, header.qoffset_z};
  for (std::size_t n = 0; n < 6; ++n) put<double>(bytes, 352 + 8 * n, quaternion[n]);
  for (std::size_t n = 0; n < 4; ++n) {
    put<double>(bytes, 400 + 8 * n, header.srow_x[n]);
    put<double>(bytes, 432 + 8 * n, header.srow_y[n]);
    put<double>(bytes, 464 + 8 * n, header.srow_z[n]);
  }
  put<std::int32_t>(bytes, 500, header.xyzt_units);
  put<std::int32_t>(bytes, 504, header.intent_code);
  return bytes + first.substr(static_cast<std::size_t>(header.vox_offset));
}

TEST(NiftiFiles, ReadsTheSecondVersionAndPairsAsTheFirst) {
  const ScratchFolder folder;
  const Volume volume = counting_volume(PixelType::int16, 3);
  NiftiFacts facts;
  facts.description = "by hand";
  facts.intent_code = NIFTI_INTENT_VECTOR;
  write_nifti(folder / "a.nii", volume, Axes::ras, facts);
  const std::string first = bytes_of(folder / "a.nii");
  store(folder / "b.nii", as_second(first));
  std::string pair = first.substr(0, 352);
  pair.replace(344, 3, "ni1");
  put<float>(pair, 108, 0);
  store(folder / "c.hdr", pair);
  store(folder / "c.img", first.substr(352));

  const Volume expected = read_nifti(folder / "a.nii");
  for (const char* name : {"b.nii", "c.hdr", "c.img"}) {
    EXPECT_EQ(kind_of(folder / name), FileKind::nifti);
    const Volume found = read_nifti(folder / name);
    EXPECT_EQ(found.data, expected.data) << name;
    EXPECT_EQ(found.grid, expected.grid) << name;
    EXPECT_EQ(read_nifti_facts(folder / name), read_nifti_facts(folder / "a.nii")) << name;
  }
}

/// More voxels on an axis than NIfTI-1 can count.
TEST(NiftiFiles, WritesTheSecondVersionWhereTheFirstIsTooSmall) {
  const ScratchFolder folder;
  Grid grid;
  grid.dims = {40000, 2, 1};
  grid.origin = {0.1, -7, 1e6 / 3};
  grid.direction = {0, -1, 0, 0.6, 0, -0.8, 0.8, 0, 0.6};
  Volume volume = make_volume(grid, PixelType::uint8);
  for (std::size_t v = 0; v < volume.data.size(); ++v) volume.data[v] = std::byte(v % 251);
  for (const char* name : {"v.nii", "v.nii.gz"}) {
    write_nifti(folder / name, volume);

    const Volume back = read_nifti(folder / name);

    EXPECT_EQ(back.data, volume.data);
    EXPECT_EQ(back.grid.dims, grid.dims);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(back.grid.origin[axis], grid.origin[axis], 1e-9);
    }
    EXPECT_EQ(read_nifti_facts(folder / name).qform_code, 1);  // both forms agree
  }
  EXPECT_EQ(bytes_of(folder / "v.nii").substr(0, 8), std::string("\x1c\x02\0\0n+2\0", 8));
}

/// Regions of every shape, of plain, gzip, scaled and turned samples, are those of the whole.
TEST(NiftiFiles, RegionsAreThoseOfTheWhole) {
  const ScratchFolder folder;
  const Volume volume = counting_volume(PixelType::float32, 3);
  write_nifti(folder / "v.nii", volume);
  write_nifti(folder / "v.nii.gz", volume);
  std::string scaled = bytes_of(folder / "v.nii");
  put<float>(scaled, 112, 0.5F);
  put<float>(scaled, 116, -3);
  store(folder / "s.nii", scaled);
  const std::vector<Region> regions = {{{0, 0, 0}, {7, 5, 4}},
                                       {{0, 0, 1}, {7, 5, 3}},
                                       {{0, 1, 1}, {7, 4, 3}},
                                       {{2, 1, 0}, {5, 4, 4}},
                                       {{6, 4, 3}, {7, 5, 4}}};
  for (const char* name : {"v.nii", "v.nii.gz", "s.nii"}) {
    for (const Axes axes : {Axes::ras, Axes::lps}) {
      const VolumeReadOptions options{axes, folder / "out.nii"};
      const Volume whole = read_volume(folder / name, "", 0, options);
      const VolumeReader reader(folder / name, "", 0, options);
      for (const Region& region : regions) {
        std::vector<float> part(static_cast<std::size_t>(3 * region.voxel_count()));
        reader.read(region, part.data());
        std::vector<float> expected;
        for (std::int64_t k = region.begin[2]; k < region.end[2]; ++k) {
          for (std::int64_t j = region.begin[1]; j < region.end[1]; ++j) {
            const std::int64_t row = 7 * (j + 5 * k);
            const auto begin = whole.samples<float>().begin();
            expected.insert(expected.end(), begin + 3 * (row + region.begin[0]),
                            begin + 3 * (row + region.end[0]));
          }
        }
        EXPECT_EQ(std::memcmp(part.data(), expected.data(), 4 * part.size()), 0) << name;
      }
    }
  }
  EXPECT_EQ(folder.entry_count(), 3);
}

/// Cut in the samples, in the last eight bytes, which are checksum and length, or with another
/// checksum; read as a whole and in blocks.
TEST(NiftiFiles, ThatGzipHasPackedAreRefusedWhereTheyAreDamaged) {
  const ScratchFolder folder;
  Grid grid;
  grid.dims = {20, 20, 20};
  Volume volume = make_volume(grid, PixelType::float64);
  for (std::size_t v = 0; v < 8000; ++v) volume.samples<double>()[v] = std::sin(v);
  write_nifti(folder / "v.nii.gz", volume);
  const std::string whole = bytes_of(folder / "v.nii.gz");
  const std::size_t size = whole.size();
  std::vector<std::string> bad = {whole};
  bad[0][size - 8] = static_cast<char>(~bad[0][size - 8]);
  for (const std::size_t lost : {size / 2, std::size_t{9}, std::size_t{8}, std::size_t{1}}) {
    bad.push_back(whole.substr(0, size - lost));
  }
  for (const std::string& bytes : bad) {
    store(folder / "v.nii.gz", bytes);
    const VolumeReader reader(folder / "v.nii.gz", "", 0, {.scratch = folder / "out.nii"});
    std::vector<double> slice(400);

    const std::string error = io_error([&] { read_nifti(folder / "v.nii.gz"); });
    const std::string in_blocks = io_error([&] {
      reader.read({{0, 0, 3}, {20, 20, 4}}, slice.data());
    });

    EXPECT_NE(error.find("truncated"), std::string::npos) << error;
    EXPECT_EQ(in_blocks, error);
  }
}

/// A series of vectors: all steps of a component stand before the next component.
TEST(NiftiFiles, SeriesOfVectorsInBlocks) {
  const ScratchFolder folder;
  const std::vector<Volume> steps = {counting_volume(PixelType::float32, 3),
                                     counting_volume(PixelType::float32, 3)};
  const Grid& grid = steps.front().grid;
  for (const char* name : {"s.nii", "s.nii.gz"}) {
    BlockVolumeWriter writer(folder / name, grid, {{"values", PixelType::float32, 3}}, {}, true);
    writer.begin_step(1);
    writer.write(0, {{0, 0, 0}, grid.dims}, steps[0].data.data());
    writer.begin_step(1.5);
    const std::size_t half = steps[1].data.size() / 2;  // two of four slices
    writer.write(0, {{0, 0, 0}, {7, 5, 2}}, steps[1].data.data());
    writer.write(0, {{0, 0, 2}, {7, 5, 4}}, steps[1].data.data() + half);
    writer.repeat_step(2);
    writer.finish();

    EXPECT_EQ(read_volume_header(folder / name).times, (std::vector<double>{1, 1.5, 2}));
    for (const int step : {2, 0, 1}) {
      EXPECT_EQ(read_volume(folder / name, "", step).data, steps[step == 0 ? 0 : 1].data);
    }
    EXPECT_NE(io_error([&] { read_volume(folder / name, "", 3); }).find("its steps are 0 to 2"),
              std::string::npos);
  }
  const nifti_1_header header = header_in(folder / "s.nii");
  EXPECT_EQ(header.dim[0], 5);
  EXPECT_EQ(header.dim[4], 3);
  EXPECT_EQ(header.toffset, 1);
  EXPECT_EQ(header.pixdim[4], 0.5F);
  const float second_component = components_in(folder / "s.nii", 3 * 7 * 5 * 4)[0];
  EXPECT_EQ(second_component, steps[0].samples<float>()[1]);
}

TEST(NiftiFiles, KeepTheFingerprint) {
  const ScratchFolder folder;
  const Volume volume = counting_volume(PixelType::uint8);
  for (const char* name : {"v.nii", "v.nii.gz"}) {
    EXPECT_EQ(read_fingerprint(folder / name), std::nullopt);
    BlockVolumeWriter writer(folder / name, volume.grid, {{"values", PixelType::uint8, 1}},
                             {.fingerprint = "0123456789abcdef"}, false);
    writer.write(0, {{0, 0, 0}, volume.grid.dims}, volume.data.data());
    writer.finish();

    EXPECT_EQ(read_fingerprint(folder / name), "0123456789abcdef");
    EXPECT_EQ(read_nifti(folder / name).data, volume.data);
  }
  write_nifti(folder / "w.nii", volume);
  EXPECT_EQ(read_fingerprint(folder / "w.nii"), std::nullopt);
}
}  // namespace
}  // namespace tetwarp::test

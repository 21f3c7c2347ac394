/// @file test_io_images.cpp
/// NRRD files, MetaImages and FreeSurfer's images that the writer made, read again: series, pairs,
/// packed ones, regions. Against other programs: tests/io/check_images.py.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/io_files.hpp"

namespace tetwarp::test {
namespace {
/// A step of a series, different in every sample.
Volume image_step(PixelType type, int components, int step) {
  Volume volume = counting_volume(type, components);
  for (std::size_t b = 0; b < volume.data.size(); b += size_of(type)) {
    volume.data[b] = static_cast<std::byte>((b * 7 + static_cast<std::size_t>(31 * step)) % 120);
  }
  return volume;
}

void write_image(const std::string& path,
                 const std::vector<Volume>& steps,
                 int compress,
                 bool is_temporal) {
  const Volume& first = steps.front();
  BlockVolumeWriter writer(path, first.grid, {{first.name, first.type, first.components}},
                           {.compress = compress}, is_temporal);
  for (std::size_t s = 0; s < steps.size(); ++s) {
    const double time = 4 + 0.5 * static_cast<double>(s);
    if (is_temporal && s + 1 == steps.size() && s > 0) {
      writer.repeat_step(time);
      continue;
    }
    if (is_temporal) writer.begin_step(time);
    for (const std::int64_t k : {2, 0}) {  // in blocks, the last first
      const Region region{{0, 0, k}, {first.grid.dims[0], first.grid.dims[1], k + 2}};
      const std::size_t slice = first.data.size() / static_cast<std::size_t>(first.grid.dims[2]);
      writer.write(0, region, steps[s].data.data() + slice * static_cast<std::size_t>(k));
    }
  }
  writer.finish();
}

void expect_grid(const Grid& found, const Grid& expected, double tolerance) {
  EXPECT_EQ(found.dims, expected.dims);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(found.origin[axis], expected.origin[axis], tolerance);
    EXPECT_NEAR(found.spacing[axis], expected.spacing[axis], tolerance);
  }
  for (std::size_t n = 0; n < 9; ++n) {
    EXPECT_NEAR(found.direction[n], expected.direction[n], tolerance);
  }
}

/// FreeSurfer stores float32 numbers: 1e-3 of an origin of 1e4.
double grid_tolerance(const std::string& name) {
  return name.find(".mg") != std::string::npos ? 2e-3 : 1e-9;
}

const std::vector<std::string> image_names{"a.nrrd", "a.mha", "a.mhd", "a.mgh", "a.mgz"};

TEST(Images, AreReadAsTheyWereWritten) {
  for (const std::string& name : image_names) {
    const bool is_mgh = name.find(".mg") != std::string::npos;
    for (const PixelType type : {PixelType::uint8, PixelType::int16, PixelType::float32}) {
      for (const int compress : {0, 3}) {
        const ScratchFolder folder;
        const Volume volume = image_step(type, is_mgh ? 1 : 3, 0);
        write_image(folder / name, {volume}, compress, false);

        const Volume whole = read_volume(folder / name);

        EXPECT_EQ(whole.data, volume.data) << name << name_of(type) << compress;
        EXPECT_EQ(whole.type, type);
        expect_grid(whole.grid, volume.grid, grid_tolerance(name));
        EXPECT_TRUE(read_volume_header(folder / name).times.empty());
        EXPECT_TRUE(read_volume_header(folder / name).left_out.empty()) << name;
        EXPECT_EQ(folder.entry_count(), name == "a.mhd" ? 2 : 1);
        std::vector<std::byte> voxel(static_cast<std::size_t>(whole.components) * size_of(type));
        VolumeReader(folder / name).read({{6, 3, 2}, {7, 4, 3}}, voxel.data());
        const std::size_t at = static_cast<std::size_t>((2 * 5 + 3) * 7 + 6) * voxel.size();
        EXPECT_TRUE(std::equal(voxel.begin(), voxel.end(),
                               volume.data.begin() + static_cast<std::ptrdiff_t>(at)));
      }
    }
  }
}

TEST(Images, HoldSeriesWithTheirTimes) {
  for (const std::string& name : image_names) {
    const bool is_mgh = name.find(".mg") != std::string::npos;
    for (const int compress : {0, 3}) {
      const ScratchFolder folder;
      std::vector<Volume> steps;
      for (int s = 0; s < 3; ++s) steps.push_back(image_step(PixelType::int16, 1, s));
      write_image(folder / name, steps, compress, true);

      const VolumeHeader header = read_volume_header(folder / name);

      EXPECT_EQ(header.times,
                (is_mgh ? std::vector<double>{0, 1, 2} : std::vector<double>{4, 4.5, 5}))
          << name;
      EXPECT_EQ(read_volume(folder / name, {}, 0).data, steps[0].data) << name;
      EXPECT_EQ(read_volume(folder / name, {}, 1).data, steps[1].data) << name;
      EXPECT_EQ(read_volume(folder / name, {}, 2).data, steps[1].data) << name;
      std::int16_t voxel = 0;
      VolumeReader(folder / name, {}, 1).read({{6, 4, 3}, {7, 5, 4}}, &voxel);
      EXPECT_EQ(voxel, steps[1].samples<std::int16_t>().back()) << name;
      EXPECT_NE(message_of<IoError>([&] { read_volume(folder / name, {}, 3); }).find("no step 3"),
                std::string::npos);
      expect_grid(header.grid, steps[0].grid, grid_tolerance(name));
    }
  }
}

TEST(Images, OfComponentsHoldSeries) {
  for (const std::string name : {"a.nrrd", "a.mha"}) {
    const ScratchFolder folder;
    const std::vector<Volume> steps{image_step(PixelType::uint8, 4, 0),
                                    image_step(PixelType::uint8, 4, 1),
                                    image_step(PixelType::uint8, 4, 2)};
    write_image(folder / name, steps, 0, true);

    EXPECT_EQ(read_volume_header(folder / name).arrays.front().components, 4);
    EXPECT_EQ(read_volume(folder / name, {}, 1).data, steps[1].data);
  }
}

TEST(Images, ThatTheirFormatDoesNotHoldAreRefused) {
  const ScratchFolder folder;
  const auto message = [&](const std::string& name, PixelType type, int components) {
    return message_of<IoError>(
        [&] { write_image(folder / name, {image_step(type, components, 0)}, 0, false); });
  };
  EXPECT_NE(message("a.mgz", PixelType::float64, 1).find("holds no float64"), std::string::npos);
  EXPECT_NE(message("a.mgh", PixelType::uint8, 3).find("one number per voxel"), std::string::npos);
  std::ofstream(folder / "b.raw") << "of another program";
  EXPECT_NE(message("b.mhd", PixelType::uint8, 1).find("would replace"), std::string::npos);
  EXPECT_EQ(bytes_of(folder / "b.raw"), "of another program");
}

/// Two arrays, in blocks, the last first; read whole and in parts, through tetwarp-read.
TEST(Images, OfVtkHoldAllArraysOfAStep) {
  const ScratchFolder folder;
  const std::string path = folder / "a.vti";
  std::vector<Volume> arrays{image_step(PixelType::uint16, 1, 0),
                             image_step(PixelType::float64, 3, 1)};
  arrays[0].name = "a < \"b\" & c";
  const Grid& grid = arrays[0].grid;
  std::vector<ArrayHeader> headers;
  for (const Volume& one : arrays) headers.push_back({one.name, one.type, one.components});
  BlockVolumeWriter writer(path, grid, headers, {.scalars = arrays[1].name}, false);
  for (const std::int64_t k : {2, 0}) {
    for (std::size_t a = 0; a < 2; ++a) {
      const std::size_t slice = arrays[a].data.size() / static_cast<std::size_t>(grid.dims[2]);
      writer.write(a, {{0, 0, k}, {grid.dims[0], grid.dims[1], k + 2}},
                   arrays[a].data.data() + slice * static_cast<std::size_t>(k));
    }
  }
  const std::int64_t written = writer.finish().bytes;
  EXPECT_EQ(written, std::ssize(bytes_of(path)));
  EXPECT_EQ(kind_of(path), FileKind::image);
  EXPECT_NE(message_of<IoError>([&] {
              write_image(folder / "b.vti", {arrays[0]}, 0, true);
            }).find("holds one step"),
            std::string::npos);
  const std::string problem = message_of<IoError>([&] { read_volume_header(path); });
  if (problem.find("libvtk9-dev") != std::string::npos) GTEST_SKIP() << problem;

  const VolumeHeader header = read_volume_header(path);

  expect_grid(header.grid, grid, 1e-9);
  EXPECT_EQ(header.active, arrays[1].name);
  for (std::size_t a = 0; a < 2; ++a) {
    EXPECT_EQ(header.arrays[a], headers[a]);
    EXPECT_EQ(read_volume(path, arrays[a].name).data, arrays[a].data);
    std::vector<std::byte> voxel(static_cast<std::size_t>(headers[a].components) *
                                 size_of(headers[a].type));
    const VolumeReader reader(path, arrays[a].name);
    for (const std::int64_t k : {3, 0}) {
      reader.read({{6, 3, k}, {7, 4, k + 1}}, voxel.data());
      const std::size_t at = static_cast<std::size_t>((k * 5 + 3) * 7 + 6) * voxel.size();
      EXPECT_TRUE(std::equal(voxel.begin(), voxel.end(),
                             arrays[a].data.begin() + static_cast<std::ptrdiff_t>(at)));
    }
  }
  EXPECT_EQ(folder.entry_count(), 1);
  EXPECT_NE(message_of<IoError>([&] { read_volume(path, "none"); }).find("no such array"),
            std::string::npos);
}

/// As 3D Slicer and teem write them: time along the last axis.
TEST(Images, OfNrrdTellTimeByTheKindOrTheDirection) {
  const ScratchFolder folder;
  const std::string begin =
      "NRRD0004\ntype: uint8\ndimension: 4\nspace: RAS\nsizes: 2 3 1 2\nencoding: raw\n"
      "space origin: (0,0,0)\nspace directions: (1,0,0) (0,1,0) (0,0,1) none\n";
  const std::string samples = "\nabcdefghijkl";
  for (const std::string extra : {"", "kinds: domain domain domain time\n",
                                  "spacings: NaN NaN NaN 250\nunits: \"mm\" \"mm\" "
                                  "\"mm\" \"ms\"\n"}) {
    std::ofstream(folder / "a.nrrd") << begin << extra << samples;
    const VolumeHeader header = read_volume_header(folder / "a.nrrd");
    ASSERT_EQ(header.times.size(), 2U);
    EXPECT_EQ(header.times[1], extra.starts_with("spacings") ? 0.25 : 1);
    EXPECT_EQ(static_cast<char>(read_volume(folder / "a.nrrd", {}, 1).data.front()), 'g');
  }
  std::ofstream(folder / "a.nrrd") << begin << "kinds: domain domain domain domain\n" << samples;
  EXPECT_NE(message_of<IoError>([&] { read_volume(folder / "a.nrrd"); }).find("kinds"),
            std::string::npos);
}

/// As teem reads them: names and words have no case, numbers may have a plus.
TEST(Images, OfNrrdHaveNamesAndWordsOfAnyCase) {
  const ScratchFolder folder;
  const std::string usual =
      "NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 2 3 1\n"
      "encoding: raw\nendian: big\nspace origin: (1,2,3)\n"
      "space directions: (1,0,0) (0,2,0) (0,0,3)\n";
  const std::string samples = "\nabcdefghijkl";
  std::ofstream(folder / "usual.nrrd") << usual << samples;
  const Volume expected = read_volume(folder / "usual.nrrd");
  EXPECT_EQ(expected.grid.origin, (Point3{-1, -2, 3}));
  const std::vector<std::pair<std::string, std::string>> changes{
      {"type: short", "Type: Short"},
      {"type: short", "type: SIGNED short int"},
      {"space: left", "Space: left"},
      {"left-posterior-superior", "Left-Posterior-Superior"},
      {"left-posterior-superior", "left posterior superior"},
      {"left-posterior-superior", "lps"},
      {"encoding: raw", "ENCODING: Raw"},
      {"endian: big", "Endian: BIG"},
      {"sizes", "Sizes"},
      {"space origin: (1,2", "Space Origin: (+1,+2.0e0"},
      {"space directions: (1", "SPACE DIRECTIONS: (+1"}};
  for (const auto& [from, to] : changes) {
    std::string text = usual;
    text.replace(text.find(from), from.size(), to);
    std::ofstream(folder / "a.nrrd") << text << samples;
    EXPECT_EQ(read_volume_header(folder / "a.nrrd").left_out, std::vector<std::string>()) << to;
    const Volume volume = read_volume(folder / "a.nrrd");
    EXPECT_EQ(volume.grid, expected.grid) << to;
    EXPECT_EQ(volume.data, expected.data) << to;
  }
  std::ofstream(folder / "a.nrrd") << usual << "Endian: little\n" << samples;
  EXPECT_NE(message_of<IoError>([&] { read_volume(folder / "a.nrrd"); }).find("is there twice"),
            std::string::npos);
}

/// Extents of axes, as ITK places them: samples are in the middle of cells unless they are nodes.
TEST(Images, OfNrrdLieInTheExtentsOfTheirAxes) {
  const ScratchFolder folder;
  struct Case {
    std::string fields;
    Point3 origin, spacing;
  };
  for (const Case& one : {Case{"spacings: 1 2 3\naxis mins: 5 6 7\n", {5.5, 7, 8.5}, {1, 2, 3}},
                          Case{"Spacings: +1 2 3\naxismins: 5 6 7\ncenters: cell ??? Cell\n",
                               {5.5, 7, 8.5},
                               {1, 2, 3}},
                          Case{"spacings: 1 2 3\naxis mins: 5 6 7\ncenterings: Node cell NODE\n",
                               {5, 7, 7},
                               {1, 2, 3}},
                          Case{"axis mins: 5 6 7\naxis maxs: 7 12 10\n", {5.5, 7, 8.5}, {1, 2, 3}},
                          Case{"axis mins: 5 6 7\n", {0, 0, 0}, {1, 1, 1}},
                          Case{"spacings: 1 2 nan\n", {0, 0, 0}, {1, 2, 1}}}) {
    std::ofstream(folder / "a.nrrd")
        << "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 3 1\nencoding: raw\n"
        << one.fields << "\nabcdef";
    const VolumeHeader header = read_volume_header(folder / "a.nrrd");
    EXPECT_EQ(header.grid.origin, one.origin) << one.fields;
    EXPECT_EQ(header.grid.spacing, one.spacing) << one.fields;
    EXPECT_TRUE(header.left_out.empty()) << one.fields;
  }
}

/// Vectors and tensors along LPS come back as they were written, turned in between.
TEST(Images, TurnComponentsAlongLps) {
  const ScratchFolder folder;
  const std::vector<std::pair<int, std::vector<int>>> signs{{3, {-1, -1, 1}},
                                                            {9, {1, 1, -1, 1, 1, -1, -1, -1, 1}}};
  for (const std::string name : {"a.nrrd", "a.mha", "a.mhd"}) {
    for (const auto& [components, sign] : signs) {
      Volume volume = make_volume(Grid{.dims = {2, 2, 1}}, PixelType::float32, components, "v");
      const std::span<float> samples = volume.samples<float>();
      for (std::size_t n = 0; n < samples.size(); ++n) samples[n] = static_cast<float>(n + 1);
      ArrayHeader array{"v", volume.type, components, default_nifti_facts(components)};
      array.nifti->component_axes = Axes::lps;
      BlockVolumeWriter writer(folder / name, volume.grid, {array}, {}, false);
      writer.write(0, {{0, 0, 0}, volume.grid.dims}, volume.data.data());
      writer.finish();

      const Volume stored = read_volume(folder / name);
      const Volume turned = read_volume(folder / name, {}, 0, {.axes = Axes::lps});

      EXPECT_EQ(turned.data, volume.data) << name << components;
      for (std::size_t n = 0; n < samples.size(); ++n) {
        const int factor = sign[n % sign.size()];
        EXPECT_EQ(stored.samples<float>()[n], static_cast<float>(factor) * samples[n]) << n;
      }
    }
  }
  const Volume scalars = make_volume(Grid{.dims = {2, 2, 1}}, PixelType::float32, 1, "v");
  ArrayHeader array{"v", scalars.type, 1, default_nifti_facts(1)};
  array.nifti->component_axes = Axes::lps;
  EXPECT_THROW(BlockVolumeWriter(folder / "b.nrrd", scalars.grid, {array}, {}, false), IoError);
  EXPECT_FALSE(std::filesystem::exists(folder / "b.nrrd"));
}

/// Bytes by hand: big-endian, without a direction.
TEST(Images, OfFreeSurferWithoutADirectionAreCoronal) {
  const ScratchFolder folder;
  std::string bytes(284, '\0');
  bytes[3] = 1;
  for (const std::size_t place : {7, 11, 15, 19}) bytes[place] = place == 19 ? 1 : 2;
  bytes[23] = 4;  // int16
  for (int n = 0; n < 8; ++n) bytes += {static_cast<char>(1), static_cast<char>(n)};
  std::ofstream(folder / "a.mgh", std::ios::binary) << bytes;

  const Volume volume = read_volume(folder / "a.mgh");

  EXPECT_EQ(volume.samples<std::int16_t>()[5], 0x105);
  EXPECT_EQ(volume.grid.direction, (std::array<double, 9>{-1, 0, 0, 0, 0, 1, 0, -1, 0}));
  EXPECT_EQ(volume.grid.origin, (Point3{1, -1, 1}));
  std::ofstream(folder / "a.mgh", std::ios::binary | std::ios::app) << "tags";
  EXPECT_EQ(read_volume_header(folder / "a.mgh").left_out.size(), 1U);
  std::ofstream(folder / "b.mgh", std::ios::binary) << bytes.substr(0, 290);
  EXPECT_NE(message_of<IoError>([&] { read_volume(folder / "b.mgh"); }).find("truncated"),
            std::string::npos);
}
TEST(Series, TheirTimesAreToldInSixDigits) {
  EXPECT_NE(times_warning("a.vtkhdf", {0.1 + 0.2, 0.1}).find(": 0.3 is followed by 0.1; "),
            std::string::npos);
  EXPECT_NE(times_warning("a.nii", {0, 0.1, 0.6000000000000001}).find("the interval 0.3;"),
            std::string::npos);
}

/// Whatever the times, a series can be read; a line names it where they come back otherwise.
TEST(Series, KeepTheirTimesOrSaySo) {
  const ScratchFolder folder;
  const Volume volume = counting_volume(PixelType::uint8, 1, "a");
  for (const std::string name : {"a.nii", "a.nrrd", "a.mha", "a.mgz", "a.vtkhdf"}) {
    for (const std::vector<double>& times : {std::vector<double>{0, 1, 2},
                                             {0, 1, 5},
                                             {2, 1, 0},
                                             {1, 1, 1},
                                             {2, 1},
                                             {0.5, 2},
                                             {7, 8}}) {
      BlockVolumeWriter writer(folder / name, volume.grid, {{"a", PixelType::uint8, 1}}, {}, true,
                               ChunkShape::rows);
      for (const double time : times) {
        writer.begin_step(time);
        writer.write(0, {{0, 0, 0}, volume.grid.dims}, volume.data.data());
      }
      writer.finish();
      const std::vector<double> read = read_volume_header(folder / name).times;
      ASSERT_EQ(read.size(), times.size()) << name;
      bool is_same = true;
      for (std::size_t n = 0; n < times.size(); ++n) {
        is_same = is_same && std::abs(read[n] - times[n]) < 1e-3;
      }
      const std::string warning = times_warning(folder / name, times);
      if (name == "a.vtkhdf") {
        EXPECT_TRUE(is_same);
        EXPECT_EQ(warning.empty(), times[1] > times[0]) << warning;
      } else {
        EXPECT_EQ(warning.empty(), is_same) << name << " " << times[1] << " " << warning;
      }
    }
  }
}

}  // namespace
}  // namespace tetwarp::test

/// @file test_io_simulation.cpp
/// Meshes and series that grow, palettes and films.
#include <gtest/gtest.h>
#include <hdf5.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <tetwarp/film.hpp>
#include <tetwarp/io.hpp>
#include <vector>

#include "io/picture/palette.hpp"
#include "io/vtkhdf/simulation_mesh.hpp"
#include "io/vtkhdf/simulation_series.hpp"
#include "tests/support/h5_numbers.hpp"
#include "tests/support/io_files.hpp"

namespace tetwarp::test {
namespace {
Mesh one_tet() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}};
}

void append(StepMeshWriter& writer, double time, double shift) {
  const std::vector<double> displacement(12, shift), stress{shift};
  const std::array<std::span<const double>, 2> values{displacement, stress};
  writer.append(time, values);
}

const std::vector<StepArray> step_arrays{{"displacement", false, 3}, {"stress", true, 1}};

TEST(StepMeshWriter, LeavesAFileThatIsCompleteAfterEveryFlush) {
  const ScratchFolder folder;
  const std::string path = folder / "grows.vtkhdf";
  StepMeshWriter writer(path, one_tet(), step_arrays);
  for (int step = 0; step < 3; ++step) {
    append(writer, 0.5 * step, step);
    EXPECT_EQ(h5_numbers(path, "VTKHDF/Steps/Values").size(), static_cast<std::size_t>(step));
    writer.flush();

    const MeshReader reader(path);

    ASSERT_EQ(reader.header().times.size(), static_cast<std::size_t>(step) + 1);
    EXPECT_EQ(reader.header().times.back(), 0.5 * step);
    EXPECT_EQ(reader.read_step(step)[1], (Point3{1.0 + step, double(step), double(step)}));
    EXPECT_EQ(h5_numbers(path, "VTKHDF/CellData/stress").size(),
              static_cast<std::size_t>(step) + 1);
  }
  EXPECT_EQ(MeshReader(path).mesh().tets, one_tet().tets);
}

TEST(StepMeshWriter, WritesStepsAtOnceAsOneByOne) {
  const ScratchFolder folder;
  const std::string together = folder / "together.vtkhdf", one_by_one = folder / "one.vtkhdf";
  {
    StepMeshWriter first(together, one_tet(), step_arrays),
        second(one_by_one, one_tet(), step_arrays);
    for (int step = 0; step < 5; ++step) {
      append(first, step, 3 * step);
      append(second, step, 3 * step);
      if (step == 1) first.flush();
      second.flush();
    }
  }
  for (const char* const name :
       {"Steps/Values", "Steps/PartOffsets", "Steps/NumberOfParts", "Steps/PointOffsets",
        "Steps/CellOffsets", "Steps/PointDataOffsets/displacement", "Steps/CellDataOffsets/stress",
        "PointData/displacement", "CellData/stress"}) {
    const std::string path = std::string("VTKHDF/") + name;
    EXPECT_EQ(h5_numbers(together, path), h5_numbers(one_by_one, path)) << name;
  }
  EXPECT_EQ(MeshReader(together).header().times, (std::vector<double>{0, 1, 2, 3, 4}));
  EXPECT_EQ(MeshReader(together).read_step(4)[0], (Point3{12, 12, 12}));
}

/// Numbers of steps that could not be written are not those of later ones.
TEST(StepMeshWriter, ForgetsStepsThatCouldNotBeWritten) {
  const ScratchFolder folder;
  const std::string path = folder / "moved.vtkhdf", elsewhere = folder / "elsewhere.vtkhdf";
  StepMeshWriter writer(path, one_tet(), step_arrays);
  append(writer, 0, 1);
  std::filesystem::rename(path, elsewhere);
  EXPECT_THROW(writer.flush(), IoError);
  std::filesystem::rename(elsewhere, path);

  append(writer, 1, 2);
  writer.flush();

  EXPECT_EQ(h5_numbers(path, "VTKHDF/Steps/Values"), (std::vector<double>{1}));
  EXPECT_EQ(h5_numbers(path, "VTKHDF/CellData/stress"), (std::vector<double>{2}));
}

TEST(StepMeshWriter, GoesOnBehindAStep) {
  const ScratchFolder folder;
  const std::string path = folder / "continued.vtkhdf";
  {
    StepMeshWriter writer(path, one_tet(), step_arrays);
    for (int step = 0; step < 4; ++step) append(writer, step, step);
  }
  {
    StepMeshWriter writer(path, 4, step_arrays, 2);
    EXPECT_EQ(h5_numbers(path, "VTKHDF/Steps/Values").size(), 4u) << "nothing is changed yet";
    writer.drop_later();
    append(writer, 10, 7);
  }  // flushes

  EXPECT_EQ(h5_numbers(path, "VTKHDF/Steps/Values"), (std::vector<double>{0, 1, 10}));
  EXPECT_EQ(h5_numbers(path, "VTKHDF/CellData/stress"), (std::vector<double>{0, 1, 7}));
  EXPECT_EQ(MeshReader(path).read_step(2)[0], (Point3{7, 7, 7}));
  EXPECT_THROW(StepMeshWriter(path, 4, step_arrays, 5), IoError) << "fewer steps";
  EXPECT_THROW(StepMeshWriter(path, 5, step_arrays, 1), IoError) << "other points";
  EXPECT_EQ(h5_numbers(path, "VTKHDF/Steps/Values").size(), 3u);
}

TEST(StepMeshWriter, KeepsNoFileOpenBetweenSteps) {
  const ScratchFolder folder;
  std::vector<StepMeshWriter> writers;
  for (int n = 0; n < 5; ++n) {
    writers.emplace_back(folder / ("body" + std::to_string(n) + ".vtkhdf"), one_tet(), step_arrays);
  }
  for (StepMeshWriter& writer : writers) {
    append(writer, 0, 1);
    writer.flush();
  }

  EXPECT_EQ(H5Fget_obj_count(H5F_OBJ_ALL, H5F_OBJ_ALL), 0);
}

TEST(StepMeshWriter, RefusesNumbersThatAreNotFinite) {
  const ScratchFolder folder;
  const std::string path = folder / "finite.vtkhdf";
  StepMeshWriter writer(path, one_tet(), step_arrays);
  append(writer, 0, 0);

  EXPECT_THROW(append(writer, 1, std::numeric_limits<double>::quiet_NaN()), IoError);
  writer.flush();

  EXPECT_EQ(h5_numbers(path, "VTKHDF/Steps/Values").size(), 1u);
}

TEST(SeriesWriter, KeepsColumnsOfNumbersVectorsAndCounts) {
  const ScratchFolder folder;
  const std::string path = folder / "series.h5";
  const std::vector<SeriesColumn> columns{
      {"time"}, {"bodies/a/centre", 3}, {"bodies/a/count", 1, true}, {"bodies/b/centre", 3}};
  const auto row = [](double n) { return std::vector<double>{n, 1, 2, n, 7 + n, n, 0, 0}; };
  {
    SeriesWriter writer(path, columns, 0);
    for (int n = 0; n < 600; ++n) writer.append(row(n));
    writer.flush();
    EXPECT_EQ(h5_numbers(path, "time").size(), 600u) << "readable while it is open";
    writer.append(row(600));
  }
  EXPECT_EQ(h5_numbers(path, "time").back(), 600) << "flushed at the end";
  {
    SeriesWriter writer = SeriesWriter::reopen(path, columns, 3);
    writer.drop_later();
    writer.append(row(40));
  }

  EXPECT_EQ(h5_numbers(path, "time"), (std::vector<double>{0, 1, 2, 3, 40}));
  EXPECT_EQ(h5_numbers(path, "bodies/a/count"), (std::vector<double>{7, 8, 9, 10, 47}));
  EXPECT_EQ(h5_numbers(path, "bodies/a/centre").size(), 15u);
  EXPECT_THROW(SeriesWriter::reopen(path, columns, 9), IoError) << "no such row";
  EXPECT_THROW(SeriesWriter::reopen(path, {{"time", 3}}, 1), IoError) << "other columns";
}

std::string file_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

Image gradient(int width, int height) {
  Image image{width, height, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.rgb.push_back(static_cast<std::uint8_t>(255 * x / width));
      image.rgb.push_back(static_cast<std::uint8_t>(255 * y / height));
      image.rgb.push_back(static_cast<std::uint8_t>(128));
    }
  }
  return image;
}

TEST(Palette, KeepsFewColorsExactly) {
  Image image{4, 1, {0, 0, 0, 255, 255, 255, 250, 10, 20, 0, 0, 0}};

  const IndexedPicture picture = index_picture(image, {0, 0, 4, 1});

  ASSERT_EQ(picture.palette.size(), 3u);
  for (std::size_t p = 0; p < 4; ++p) {
    const Color& color = picture.palette[picture.indices[p]];
    EXPECT_TRUE(std::equal(color.begin(), color.end(), image.rgb.begin() + 3 * long(p)));
  }
}

/// 256 boxes of equal size over the plane of colors would be 16 wide.
TEST(Palette, StaysNearTheColorsOfAGradient) {
  const Image image = gradient(200, 200);

  const IndexedPicture picture = index_picture(image, {0, 0, 200, 200});

  EXPECT_EQ(picture.palette.size(), 256u);
  int largest = 0;
  for (std::size_t p = 0; p < picture.indices.size(); ++p) {
    for (std::size_t c = 0; c < 3; ++c) {
      const int distance = std::abs(picture.palette[picture.indices[p]][c] - image.rgb[3 * p + c]);
      largest = std::max(largest, distance);
    }
  }
  EXPECT_LE(largest, 16);
}

TEST(Film, IsAGifThatLoopsOrNamesThePackage) {
  const ScratchFolder folder;
  const std::string path = folder / "film.gif";
  try {
    FilmWriter film(path);
    film.append(gradient(40, 30), 0.1);
    film.append(gradient(40, 30), 0.033);
    EXPECT_THROW(film.append(gradient(30, 40), 0.1), IoError) << "another size";
    film.finish();
  } catch (const IoError& error) {
    EXPECT_NE(std::string(error.what()).find("libgif-dev"), std::string::npos) << error.what();
    return;
  }
  const std::string bytes = file_bytes(path);
  EXPECT_TRUE(bytes.starts_with("GIF89a"));
  EXPECT_NE(bytes.find("NETSCAPE2.0"), std::string::npos);
  EXPECT_EQ(bytes.back(), ';');
}
}  // namespace
}  // namespace tetwarp::test

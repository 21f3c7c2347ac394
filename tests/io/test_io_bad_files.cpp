/// @file test_io_bad_files.cpp
/// Damaged and invalid files, and files of other formats: each gives one line that names the error.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <limits>

#include "io/files/finished_file.hpp"
#include "tests/support/io_files.hpp"

namespace tetwarp::test {
namespace {
using Mode = Hdf5Editor::Mode;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// A good volume and a good mesh to damage.
class BadFiles : public testing::Test {
 protected:
  BadFiles() {
    write_volumes(volume, {&samples});
    write_mesh(mesh, two_tets(), slides({0, 1}));
  }

  /// Reads everything and expects one line naming file, dataset and `words`.
  void expect_volume_error(const std::string& words) const {
    const std::string error = io_error([&] {
      read_volume_header(volume);
      read_volume(volume);
    });
    expect_line(error, volume, words);
  }

  void expect_mesh_error(const std::string& words) const {
    const std::string error = io_error([&] { MeshReader(mesh).read_step(1); });
    expect_line(error, mesh, words);
  }

  static void expect_line(const std::string& error,
                          const std::string& file,
                          const std::string& words) {
    EXPECT_TRUE(error.starts_with(file + ": ")) << error;
    EXPECT_NE(error.find(words), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }

  ScratchFolder folder;
  Volume samples = counting_volume(PixelType::int16);
  std::string volume = folder / "volume.vtkhdf";
  std::string mesh = folder / "mesh.vtkhdf";
};

TEST_F(BadFiles, AreNamedWhenTheyAreMissingOrNoHdf5) {
  expect_line(io_error([&] { read_volume(folder / "none"); }), folder / "none", "No such file");
  expect_line(io_error([&] { read_volume(folder / ""); }), folder / "", "DICOM");
  std::ofstream(volume) << "P5 some other format";
  expect_volume_error("is not an HDF5 file");
  std::ofstream(volume, std::ios::trunc).flush();
  expect_volume_error("is not an HDF5 file");
}

TEST_F(BadFiles, AreNamedWhenTheyAreTruncated) {
  const auto whole = std::filesystem::file_size(volume);
  for (const auto size : {whole - 1, whole / 2, whole / 4, std::uintmax_t{100}}) {
    std::filesystem::resize_file(volume, size);
    expect_volume_error("truncated");
  }
}

TEST_F(BadFiles, AreNamedWhenVolumeAndMeshAreSwapped) {
  expect_line(io_error([&] { read_volume(mesh); }), mesh, "check the order of the files");
  expect_line(io_error([&] { MeshReader reader(volume); }), volume, "check the order of the files");
}

TEST_F(BadFiles, AreNamedWhenTheTypeIsAnotherOrMissing) {
  Hdf5Editor(volume).text("VTKHDF", "Type", "PolyData");
  expect_volume_error("Type is 'PolyData', expected 'ImageData'");
  Hdf5Editor(volume).attribute<double>("VTKHDF", "Type", {1});
  expect_volume_error("Type is not one string");
  Hdf5Editor(volume).remove_attribute("VTKHDF", "Type");
  expect_volume_error("missing attribute Type");
  Hdf5Editor(volume).remove("VTKHDF");
  expect_volume_error("/VTKHDF: missing group");
}

TEST_F(BadFiles, AreNamedWhenTheGridIsImpossible) {
  const auto error = [&](const char* name, const std::vector<double>& values, const char* words) {
    write_volumes(volume, {&samples});
    Hdf5Editor(volume).attribute("VTKHDF", name, values);
    expect_volume_error(words);
  };
  error("Spacing", {1, 0, 1}, "spacing 0.0");
  error("Spacing", {1, -1, 1}, "spacing -1.0");
  error("Spacing", {1, nan, 1}, "spacing");
  error("Spacing", {1, 1}, "attribute Spacing holds 2 numbers, expected 3");
  error("Origin", {nan, 0, 0}, "origin is not finite");
  error("Direction", {1, 0, 0, 1, 0, 0, 0, 0, 1}, "direction is singular");
  error("WholeExtent", {0, 6, 0, 4, 0, 4}, "has shape [4][5][7]");
  error("WholeExtent", {0, 6, 0, 4, 3, 0}, "-2 voxels on axis 2");
  error("WholeExtent", {0, 6.5, 0, 4, 0, 3}, "expected whole numbers");
  error("WholeExtent", {0, 6, 0, 4, -9e15, 9e15}, "voxels on axis 2, expected 1 to 2^30");
  write_volumes(volume, {&samples});
  Hdf5Editor(volume).remove_attribute("VTKHDF", "Spacing");
  expect_volume_error("missing attribute Spacing");
}

TEST_F(BadFiles, AreRefusedBeforeAbsurdSizesAreAllocated) {
  const std::vector<double> none;
  Hdf5Editor(volume)
      .attribute<double>("VTKHDF", "WholeExtent", {0, 0xFFFFF, 0, 0xFFFFF, 0, 0xFFFF})
      .dataset("VTKHDF/PointData/values", {0x10000, 0x100000, 0x100000}, none);
  expect_volume_error("TiB of memory");
  Hdf5Editor(mesh)
      .dataset<std::int64_t>("VTKHDF/NumberOfPoints", {1}, {1LL << 30})
      .dataset("VTKHDF/Points", {1ULL << 40, 3}, none)
      .dataset("VTKHDF/PointData/displacement", {1ULL << 40, 3}, none);
  expect_mesh_error("GiB of memory");
}

TEST_F(BadFiles, AreNamedWhenAnArrayDoesNotExistOrHoldsNoNumbers) {
  expect_line(io_error([&] { read_volume(volume, "x"); }), volume, "holds values");
  expect_line(io_error([&] { read_volume(volume, "a/b"); }), volume, "missing dataset");
  const hid_t text = H5Tcopy(H5T_C_S1);
  Hdf5Editor(volume).dataset("VTKHDF/PointData/values", {4, 5, 7}, std::vector<std::uint8_t>{},
                             text);
  H5Tclose(text);
  expect_volume_error("holds no array of numbers");
  expect_line(io_error([&] { read_volume(volume, "values"); }), volume, "that are not numbers");
}

TEST_F(BadFiles, AreNamedWhenAStepDoesNotExist) {
  expect_line(io_error([&] { read_volume(volume, "", 1); }), volume, "has no step 1");
  const MeshReader reader(mesh);
  expect_line(io_error([&] { reader.read_step(2); }), mesh, "no step 2, its steps are 0 to 1");
  expect_line(io_error([&] { reader.read_step(-1); }), mesh, "no step -1");
  const auto far = io_error([&] { MeshReader(mesh, {.rest_step = 7, .rest_file = {}}); });
  expect_line(far, mesh, "no step 7");
}

TEST_F(BadFiles, AreNamedWhenStepsAreInconsistent) {
  Hdf5Editor(mesh).attribute<std::int32_t>("VTKHDF/Steps", "NSteps", {3});
  expect_mesh_error("NSteps is 3, Values has 2 entries");
  Hdf5Editor(mesh).attribute<std::int32_t>("VTKHDF/Steps", "NSteps", {-1});
  expect_mesh_error("NSteps is -1");
  Hdf5Editor(mesh).remove_attribute("VTKHDF/Steps", "NSteps");
  expect_mesh_error("was not finished");
}

TEST_F(BadFiles, AreNamedWhenMeshOffsetsLeaveTheData) {
  const auto error = [&](const char* name, std::int64_t value, const char* words) {
    write_mesh(mesh, two_tets(), slides({0, 1}));
    Hdf5Editor(mesh).dataset<std::int64_t>(name, {2}, {0, value});
    expect_mesh_error(words);
  };
  error("VTKHDF/Steps/PointOffsets", 1, "/VTKHDF/Points: rows 1");
  error("VTKHDF/Steps/PointOffsets", -5, "PointOffsets: entry 1 is -5");
  error("VTKHDF/Steps/CellOffsets", std::numeric_limits<std::int64_t>::max(), "CellOffsets");
  error("VTKHDF/Steps/PartOffsets", 1, "refers to parts 1");
  error("VTKHDF/Steps/PointDataOffsets/displacement", 6, "/PointData/displacement: rows 6");
}

/// Rows of two steps at the points of one: which of them a step has, only offsets tell.
TEST_F(BadFiles, AreNamedWhenRowsOfDisplacementsHaveNoOffsets) {
  Hdf5Editor(mesh).remove("VTKHDF/Steps/PointDataOffsets");
  expect_mesh_error("has 10 rows for 5 points, and no dataset Steps/PointDataOffsets/displacement");
}

TEST_F(BadFiles, AreNamedWhenAMeshHasOtherCells) {
  Hdf5Editor(mesh).dataset<std::uint8_t>("VTKHDF/Types", {2}, {10, 14});
  expect_mesh_error("cell 1 has type 14 (VTK_PYRAMID)");
  Hdf5Editor(mesh).dataset<std::uint8_t>("VTKHDF/Types", {2}, {10, 12});
  expect_mesh_error("entry 2 of a part is 8, expected 12");
  Hdf5Editor(mesh).dataset<std::int64_t>("VTKHDF/NumberOfCells", {1}, {0});
  expect_mesh_error("no tetrahedron");
}

TEST_F(BadFiles, AreNamedWhenConnectivityIsWrong) {
  const auto error = [&](const char* name, const std::vector<std::int64_t>& values,
                         const char* words) {
    write_mesh(mesh, two_tets(), slides({0, 1}));
    Hdf5Editor(mesh).dataset(name, {values.size()}, values);
    expect_mesh_error(words);
  };
  error("VTKHDF/Connectivity", {0, 1, 2, 3, 1, 2, 3, 5}, "cell 1 refers to node 5");
  error("VTKHDF/Connectivity", {0, 1, -2, 3, 1, 2, 3, 4}, "cell 0 refers to node -2");
  error("VTKHDF/Connectivity", {0, 1, 2, 3}, "/VTKHDF/Connectivity: rows 0");
  error("VTKHDF/Offsets", {0, 8, 4}, "/VTKHDF/Offsets: entry 1");
  error("VTKHDF/Offsets", {0, 3, 8}, "/VTKHDF/Offsets: entry 1");
  error("VTKHDF/Offsets", {0, 4}, "/VTKHDF/Offsets: rows 0");
  error("VTKHDF/NumberOfPoints", {-5}, "/VTKHDF/Points: rows 0");
  error("VTKHDF/NumberOfPoints", {5, 5}, "differ in length");
  error("VTKHDF/NumberOfConnectivityIds", {7}, "NumberOfConnectivityIds is 7 for 2 cells");
}

TEST_F(BadFiles, AreNamedWhenNodesAreNotFinite) {
  std::vector<double> points(15, 0.0);
  points[7] = nan;
  Hdf5Editor(mesh).dataset("VTKHDF/Points", {5, 3}, points);
  expect_mesh_error("/VTKHDF/Points: node 2 is not finite");

  write_mesh(mesh, two_tets());
  points[7] = std::numeric_limits<double>::infinity();
  Hdf5Editor(mesh).dataset("VTKHDF/PointData/displacement", {5, 3}, points);
  const std::string error = io_error([&] { MeshReader(mesh).read_step(0); });
  expect_line(error, mesh, "/VTKHDF/PointData/displacement: node 2 is not finite");
}

TEST_F(BadFiles, AreNamedWhenTheDisplacementHasAnotherShape) {
  Hdf5Editor(mesh).dataset("VTKHDF/PointData/displacement", {15, 2}, std::vector<double>(30, 0));
  expect_mesh_error("/VTKHDF/PointData/displacement: expected shape [n][3]");
  Hdf5Editor(mesh).dataset("VTKHDF/PointData/displacement", {9, 3}, std::vector<double>(27, 0));
  expect_mesh_error("/VTKHDF/PointData/displacement: rows 5");
}

TEST_F(BadFiles, AreNamedWhenTheRestFileHasOtherNodes) {
  Mesh small = two_tets();
  small.tets.pop_back();
  small.rest_positions.pop_back();
  write_mesh(folder / "rest", small);
  const std::string error =
      io_error([&] { MeshReader(mesh, {.rest_step = 0, .rest_file = folder / "rest"}); });
  expect_line(error, folder / "rest", "has 4 nodes, the mesh has 5");
}

TEST_F(BadFiles, AreNotWrittenWithNamesOrShapesThatVtkCannotRead) {
  const Volume dotted = counting_volume(PixelType::uint8, 1, "a.b");
  Volume moved = counting_volume(PixelType::uint8, 1, "moved");
  moved.grid.origin[0] += 1;
  Volume shorter = counting_volume(PixelType::uint8, 1, "shorter");
  shorter.data.pop_back();
  const auto error = [&](const std::vector<const Volume*>& volumes, const char* words) {
    const std::string path = folder / "out";
    expect_line(io_error([&] { write_volumes(path, volumes); }), path, words);
  };

  error({&dotted}, "must not be empty or hold '/' or '.'");
  error({&samples, &samples}, "two arrays have this name");
  error({&samples, &moved}, "another grid");
  error({&shorter}, "bytes");
  error({}, "no volume");
  EXPECT_EQ(folder.entry_count(), 2);
}

TEST_F(BadFiles, AreNotLeftBehindByAFullDisk) {
  Grid grid;
  grid.dims = {64, 64, 64};
  Volume large = make_volume(grid, PixelType::float32);
  for (float& sample : large.samples<float>()) sample = 1;
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{400'000, before.rlim_max};  // bytes: inside the samples
  setrlimit(RLIMIT_FSIZE, &limit);

  const std::string written = io_error([&] { write_volumes(folder / "out", {&large}); });
  const std::string nifti = io_error([&] { write_nifti(folder / "out.nii", large); });
  const std::string text =
      io_error([&] { write_finished_file(folder / "out.json", std::string(500'000, ' ')); });

  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, old_handler);
  expect_line(written, folder / "out", "cannot be written: File too large");
  expect_line(nifti, folder / "out.nii", "cannot be written");
  expect_line(text, folder / "out.json", "cannot be written");
  EXPECT_EQ(folder.entry_count(), 2);
}

TEST_F(BadFiles, AreNotLeftBehindByExitsThatUnwindNothing) {
  const FinishedFile unfinished(folder / "out");
  ASSERT_EQ(folder.entry_count(), 3);

  remove_unfinished_files();

  EXPECT_EQ(folder.entry_count(), 2);
}

TEST_F(BadFiles, AreNotWrittenOverFoldersOrDevices) {
  EXPECT_THROW(write_volumes(folder / ".", {&samples}), IoError);
  EXPECT_THROW(write_volumes("/dev/null", {&samples}), IoError);
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
  write_volumes(folder / "file", {&samples});
  EXPECT_THROW(write_volumes(folder / "file/out", {&samples}), IoError);
}
}  // namespace
}  // namespace tetwarp::test

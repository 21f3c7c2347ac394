/// @file test_left_out.cpp
/// Every reader names what it does not keep: files that hold all that their format allows.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include <tetwarp/mesh_import.hpp>
#include <tetwarp/scene_io.hpp>

#include "tests/support/contact/contact_files.hpp"
#include "tests/support/io_files.hpp"
#include "tests/support/nifti_files.hpp"

namespace tetwarp::test {
namespace {
/// Empty, and why in `error`, where this build lacks the library.
ImportedMesh mesh_of(const std::string& path, const std::string& text, std::string& error) {
  std::ofstream(path) << text;
  ImportedMesh mesh;
  error = io_error([&] { mesh = import_mesh(path); });
  EXPECT_TRUE(error.empty() || error.find("this build cannot read") != std::string::npos) << error;
  return mesh;
}

std::set<std::string> arrays_of(const ImportedMesh& mesh, bool of_cells) {
  std::set<std::string> names;
  for (const MeshArray& array : mesh.arrays) {
    if (array.is_of_cells == of_cells) names.insert(array.name);
  }
  return names;
}

std::set<std::string> set_of(const std::vector<std::string>& names) {
  return {names.begin(), names.end()};
}

/// Two arrays of every kind, at points and in cells.
std::string legacy_attributes(int rows) {
  const auto numbers = [&](int count) {
    std::string text;
    for (int n = 0; n < rows * count; ++n) text += "0.5 ";
    return text + "\n";
  };
  std::string text;
  for (const std::string n : {"1", "2"}) {
    text += "SCALARS s" + n + " double 1\nLOOKUP_TABLE default\n" + numbers(1);
    text += "COLOR_SCALARS c" + n + " 3\n" + numbers(3);
    text += "VECTORS v" + n + " float\n" + numbers(3);
    text += "NORMALS n" + n + " float\n" + numbers(3);
    text += "TENSORS t" + n + " double\n" + numbers(9);
    text += "TEXTURE_COORDINATES x" + n + " 2 float\n" + numbers(2);
  }
  return text;
}

TEST(LeftOut, OfLegacyVtkFilesAllArraysOfAKindAreKept) {
  const ScratchFolder folder;
  std::string error;
  const ImportedMesh mesh =
      mesh_of(folder / "a.vtk",
              "# vtk DataFile Version 3.0\nall\nASCII\nDATASET UNSTRUCTURED_GRID\n"
              "FIELD FieldData 2\nauthor 1 1 string\nnobody\nyear 1 1 int\n2000\n"
              "POINTS 4 double\n0 0 0 1 0 0 0 1 0 0 0 1\nCELLS 2 9\n4 0 1 2 3\n3 0 1 2\n"
              "CELL_TYPES 2\n10\n5\nCELL_DATA 2\n" +
                  legacy_attributes(2) + "POINT_DATA 4\n" + legacy_attributes(4) +
                  "SCALARS mapped double 1\nLOOKUP_TABLE mine\n0 0 0 0\nLOOKUP_TABLE mine 2\n"
                  "0 0 0 1 1 1 1 1\nFIELD FieldData 2\nnames 1 4 string\na\nb\nc\nd\n"
                  "long 10 4 float\n" +
                  std::string("1 2 3 4 5 6 7 8 9 10 ") +
                  "1 2 3 4 5 6 7 8 9 10 1 2 3 4 5 6 7 8 9 10 "
                  "1 2 3 4 5 6 7 8 9 10\n",
              error);
  if (!error.empty()) GTEST_SKIP() << error;

  const std::set<std::string> all{"s1", "s2", "c1", "c2", "v1", "v2",
                                  "n1", "n2", "t1", "t2", "x1", "x2"};
  std::set<std::string> at_points = all, in_cells = all;
  at_points.insert("mapped");
  in_cells.insert("original_cell");
  EXPECT_EQ(arrays_of(mesh, false), at_points);
  EXPECT_EQ(arrays_of(mesh, true), in_cells);
  EXPECT_EQ(
      set_of(mesh.left_out),
      (std::set<std::string>{"field array 'author'", "field array 'year'", "point array 'names'",
                             "point array 'long'", "lookup table 'mine'"}));
  EXPECT_EQ(mesh.skipped, (std::map<std::string, std::int64_t>{{"vtkTriangle", 1}}));
}

TEST(LeftOut, OfXmlFilesNamesOfComponentsFieldsAndLaterSteps) {
  const ScratchFolder folder;
  std::string error;
  const auto array = [](const std::string& attributes, const std::string& values) {
    return "<DataArray " + attributes + " format=\"ascii\">" + values + "</DataArray>";
  };
  const ImportedMesh mesh = mesh_of(
      folder / "a.vtu",
      "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">"
      "<UnstructuredGrid TimeValues=\"3 4\"><FieldData>" +
          array("type=\"Float64\" Name=\"dose\" NumberOfTuples=\"1\"", "2") +
          "</FieldData><Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><PointData>" +
          array("type=\"Float32\" Name=\"u\" NumberOfComponents=\"2\" ComponentName0=\"a\" "
                "ComponentName1=\"b\"",
                "0 0 0 0 0 0 0 0") +
          "</PointData><CellData>" + array("type=\"Int32\" Name=\"part\"", "7") +
          "</CellData><Points>" +
          array("type=\"Float64\" NumberOfComponents=\"3\" Name=\"p\"", "0 0 0 1 0 0 0 1 0 0 0 1") +
          "</Points><Cells>" + array("type=\"Int64\" Name=\"connectivity\"", "0 1 2 3") +
          array("type=\"Int64\" Name=\"offsets\"", "4") +
          array("type=\"UInt8\" Name=\"types\"", "10") +
          "</Cells></Piece></UnstructuredGrid></VTKFile>\n",
      error);
  if (!error.empty()) GTEST_SKIP() << error;

  EXPECT_EQ(arrays_of(mesh, false), (std::set<std::string>{"u"}));
  EXPECT_EQ(arrays_of(mesh, true), (std::set<std::string>{"part", "original_cell"}));
  EXPECT_EQ(
      set_of(mesh.left_out),
      (std::set<std::string>{"field array 'dose'", "names of the components of point array 'u'",
                             "times of the steps, which are numbered from 0",
                             "steps after the first of all arrays but the displacement"}));
}

/// A cell in two groups, groups of all dimensions, three kinds of data, other sections.
TEST(LeftOut, OfGmshFilesSecondGroupsAreKeptAndTheRestIsNamed) {
  const ScratchFolder folder;
  std::string error;
  const auto data = [](const std::string& kind, const std::string& name, const std::string& rows) {
    return "$" + kind + "\n1\n\"" + name + "\"\n1\n0\n3\n0\n1\n" + rows + "$End" + kind + "\n";
  };
  const ImportedMesh mesh = mesh_of(
      folder / "a.msh",
      "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
      "$PhysicalNames\n3\n2 9 \"skin\"\n3 1 \"bone\"\n3 2 \"implant\"\n$EndPhysicalNames\n"
      "$Entities\n1 0 1 1\n1 0 0 0 1 5\n1 0 0 0 1 1 1 1 9 0\n1 0 0 0 1 1 1 2 1 2 0\n"
      "$EndEntities\n"
      "$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n"
      "$Elements\n3 3 1 3\n0 1 15 1\n1 1\n2 1 2 1\n2 1 2 3\n3 1 4 1\n3 1 2 3 4\n$EndElements\n"
      "$Periodic\n0\n$EndPeriodic\n" +
          data("NodeData", "heat", "4\n1 0\n2 0\n3 0\n4 0\n") +
          data("ElementData", "stress", "1\n3 7\n") + "$Comments\nnone\n$EndComments\n",
      error);
  if (!error.empty()) GTEST_SKIP() << error;

  EXPECT_EQ(arrays_of(mesh, true), (std::set<std::string>{"original_cell", "group", "group_2"}));
  for (const MeshArray& array : mesh.arrays) {
    if (!array.name.starts_with("group")) continue;
    std::int64_t group = 0;
    ASSERT_EQ(array.data.size(), sizeof group);
    std::memcpy(&group, array.data.data(), sizeof group);
    EXPECT_EQ(group, array.name == "group" ? 1 : 2);
    EXPECT_EQ(array.value_names,
              (std::map<std::int64_t, std::string>{{1, "bone"}, {2, "implant"}}));
  }
  EXPECT_EQ(
      set_of(mesh.left_out),
      (std::set<std::string>{"data 'heat'", "data 'stress'", "group 'skin' of dimension 2",
                             "group 5 of dimension 0", "section $Comments", "section $Periodic"}));
  EXPECT_EQ(mesh.skipped.size(), 2U);
}

TEST(LeftOut, OfVtkhdfMeshesArraysFieldsAndCellsOfFewerDimensions) {
  const ScratchFolder folder;
  const MeshArray heat{"heat", false, PixelType::float32, 1, std::vector<std::byte>(20)};
  const MeshArray part{"part", true, PixelType::uint8, 1, std::vector<std::byte>(2)};
  write_mesh(folder / "m.vtkhdf", two_tets(), slides({1}), {0}, {heat, part});
  Hdf5Editor(folder / "m.vtkhdf")  // a triangle between the tetrahedra, a vertex behind them
      .dataset<std::int64_t>("VTKHDF/NumberOfCells", {1}, {4})
      .dataset<std::int64_t>("VTKHDF/NumberOfConnectivityIds", {1}, {12})
      .dataset<std::int64_t>("VTKHDF/Connectivity", {12}, {0, 1, 2, 3, 1, 2, 3, 1, 2, 3, 4, 0})
      .dataset<std::int64_t>("VTKHDF/Offsets", {5}, {0, 4, 7, 11, 12})
      .dataset<std::uint8_t>("VTKHDF/Types", {4}, {10, 5, 10, 1})
      .dataset<double>("VTKHDF/FieldData/dose", {1}, {2});

  const MeshReader reader(folder / "m.vtkhdf");
  std::vector<std::string> left_out;
  const Surface surface = read_surface(folder / "m.vtkhdf", &left_out);

  EXPECT_EQ(reader.mesh().tets, two_tets().tets);
  EXPECT_EQ(reader.read_step(0)[0], (Point3{1, 0, 0}));
  EXPECT_EQ(set_of(reader.header().not_read),
            (std::set<std::string>{"PointData/heat", "CellData/part", "FieldData/dose",
                                   "1 5 (VTK_TRIANGLE)", "1 1 (VTK_VERTEX)"}));
  EXPECT_EQ(surface.points, (std::vector<Point3>{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
  EXPECT_EQ(set_of(left_out),
            (std::set<std::string>{"PointData/heat", "CellData/part", "FieldData/dose",
                                   "2 10 (VTK_TETRA)", "1 1 (VTK_VERTEX)"}));
}

TEST(LeftOut, OfNiftiHeadersFieldsAndExtensions) {
  const ScratchFolder folder;
  nifti_1_header header = float_header({3, 2, 2}, 1);
  header.vox_offset = 352 + 32;
  header.sform_code = header.qform_code = 1;
  header.srow_x[0] = header.srow_y[1] = header.srow_z[2] = 2;
  header.dim_info = 57;
  header.slice_code = 1;
  header.toffset = 5;
  std::strcpy(header.aux_file, "notes.txt");
  std::string bytes(reinterpret_cast<const char*>(&header), sizeof header);
  const std::int32_t extension[2] = {32, 4};
  bytes += std::string("\1\0\0\0", 4) +
           std::string(reinterpret_cast<const char*>(extension), sizeof extension) +
           std::string(24, 'x') + std::string(48, '\0');
  std::ofstream(folder / "a.nii", std::ios::binary) << bytes;

  EXPECT_EQ(
      set_of(read_volume_header(folder / "a.nii").left_out),
      (std::set<std::string>{"qform, which differs from the sform", "dim_info",
                             "times of slices (slice_code, slice_duration, slice_start, slice_end)",
                             "toffset", "aux_file", "extension of code 4, 32 bytes"}));
}

/// A file with all that is read, and something beside it in each group.
TEST(LeftOut, OfContactProblemsWhatNoSolverReads) {
  const ScratchFolder folder;
  ContactProblem problem = sliding_point();
  problem.impulse_guess = {1, 0, 0};
  write_contact_problem(folder / "p.hdf5", problem, "a title", "a description");
  EXPECT_EQ(read_contact_header(folder / "p.hdf5").not_read, std::vector<std::string>());
  Hdf5Editor(folder / "p.hdf5")
      .dataset<double>("fclib_local/vectors/s", {1}, {0})
      .dataset<double>("fclib_local/info/author", {1}, {0})
      .dataset<double>("guesses/1/v", {3}, {0, 0, 0})
      .group("blocks")
      .group("certified");

  EXPECT_EQ(set_of(read_contact_header(folder / "p.hdf5").not_read),
            (std::set<std::string>{"fclib_local/vectors/s", "fclib_local/info/author",
                                   "guesses/1/v", "blocks", "certified"}));
}

/// The range that viewers show and the time of a repetition come back from a VTKHDF file.
TEST(LeftOut, OfNiftiHeadersNotTheRangeOfDisplayAndTheTimeStep) {
  const ScratchFolder folder;
  NiftiFacts facts;
  facts.cal_min = -100;
  facts.cal_max = 250;
  facts.time_step = 2.5;
  Volume volume = counting_volume(PixelType::int16);
  BlockVolumeWriter writer(folder / "a.vtkhdf", volume.grid,
                           {{"values", PixelType::int16, 1, facts}}, {}, false, ChunkShape::rows);
  writer.write(0, {{0, 0, 0}, volume.grid.dims}, volume.data.data());
  writer.finish();
  write_nifti(folder / "a.nii", volume, Axes::ras,
              read_volume_header(folder / "a.vtkhdf").arrays[0].nifti);

  EXPECT_EQ(header_in(folder / "a.nii").cal_min, -100);
  EXPECT_EQ(header_in(folder / "a.nii").cal_max, 250);
  EXPECT_EQ(header_in(folder / "a.nii").pixdim[4], 2.5);
  EXPECT_EQ(read_nifti_facts(folder / "a.nii"), facts);
}

/// Some programs leave the field 0. With extensions the samples may begin anywhere.
TEST(LeftOut, OfNiftiFilesNoSamplesWhereVoxOffsetIs0) {
  const ScratchFolder folder;
  nifti_1_header header = float_header({3, 2, 2}, 1);
  header.vox_offset = 0;
  write_constant(folder / "a.nii", header, {7});
  const Volume volume = read_nifti(folder / "a.nii");
  EXPECT_TRUE(std::ranges::all_of(volume.samples<float>(), [](float s) { return s == 7; }));

  std::fstream(folder / "a.nii", std::ios::in | std::ios::out | std::ios::binary)
      .seekp(348)
      .write("\1", 1);
  EXPECT_NE(io_error([&] {
              read_nifti(folder / "a.nii");
            }).find("vox_offset: is 0.000000, expected at least 352 and the end of the ext"),
            std::string::npos);
}
}  // namespace
}  // namespace tetwarp::test

/// @file test_mesh_import_vtk.cpp
/// Meshes of VTK, and series of files. In a build without it the error is checked and tests skip.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <tetwarp/io.hpp>
#include <tetwarp/mesh_import.hpp>

#include "tests/support/mesh_files.hpp"

namespace tetwarp::test {
namespace {
TEST_F(MeshImport, ReadsVtkFilesWithStepsAndCountsWhatItLeavesOut) {
  const auto legacy = imported("a.vtk", legacy_file());
  const auto renamed = imported("b.vtk", legacy_file("u"), {.displacement = "u"});
  const auto still = imported("c.vtk", legacy_file("u"));
  const auto steps = imported("d.vtu", xml_file());
  if (!legacy) GTEST_SKIP() << error;

  for (const auto& mesh : {legacy, renamed, steps}) {
    ASSERT_TRUE(mesh);
    expect_two_tets(*mesh);
    EXPECT_EQ(mesh->skipped, (std::map<std::string, std::int64_t>{{"vtkTriangle", 1}}));
  }
  ASSERT_TRUE(still);
  EXPECT_EQ(still->displacements.size(), 0U);
  EXPECT_EQ(legacy->times, std::vector<double>{0});
  EXPECT_EQ(steps->times, (std::vector<double>{0, 1}));
  EXPECT_EQ(steps->displacements.front(), std::vector<Point3>(5, Point3{0, 0, 0}));
}

/// Voxel cells are hexahedra in another order; wedges and pyramids are hexahedra with repeated
/// nodes.
TEST_F(MeshImport, MakesHexahedraOfVoxelsWedgesAndPyramids) {
  const auto mesh =
      imported("a.vtk", legacy_cells("0 0 0 1 0 0 0 1 0 1 1 0 0 0 1 1 0 1 0 1 1 1 1 1", 8,
                                     {{11, 8}, {13, 6}, {14, 5}}));
  if (!mesh) GTEST_SKIP() << error;

  EXPECT_EQ(mesh->mesh.hexes,
            (std::vector<std::array<std::int32_t, 8>>{
                {0, 1, 3, 2, 4, 5, 7, 6}, {0, 1, 2, 2, 3, 4, 5, 5}, {0, 1, 2, 3, 4, 4, 4, 4}}));
  EXPECT_EQ(numbers_of(mesh->arrays.back()), (std::vector<std::int64_t>{0, 1, 2}));
}

/// A list, a series and numbered files of one mesh whose points move, and one of its blocks.
TEST_F(MeshImport, ReadsSeriesOfFilesAndMovingPoints) {
  const auto moved = [](double by) {
    std::string text = legacy_file("u");
    const std::string last = "1 1 1";
    return text.replace(text.find(last), last.size(), std::to_string(1 + by) + " 1 1");
  };
  for (const auto& [name, by] : {std::pair{"s_10.vtk", 2.0}, {"s_9.vtk", 1.0}, {"s_8.vtk", 0.0}}) {
    std::ofstream(folder_ / name) << moved(by);
  }
  const auto list =
      imported("a.pvd",
               "<?xml version=\"1.0\"?><VTKFile type=\"Collection\"><Collection>"
               "<DataSet timestep=\"0.5\" part=\"0\" file=\"s_9.vtk\"/>"
               "<DataSet timestep=\"0.25\" part=\"0\" file=\"s_8.vtk\"/>"
               "<DataSet timestep=\"4\" part=\"0\" file=\"s_10.vtk\"/></Collection></VTKFile>");
  if (!list) GTEST_SKIP() << error;
  const auto series = imported("a.vtk.series",
                               R"({"file-series-version": "1.0", "files": [
      {"name": "s_8.vtk", "time": 0.25}, {"name": "s_9.vtk", "time": 0.5},
      {"name": "s_10.vtk", "time": 4}]})");
  const ImportedMesh numbered = import_mesh(folder_ / "s_*.vtk");
  const ImportedMesh named = import_mesh(folder_ / "s_*.vtk", {.displacement = "u"});

  ASSERT_TRUE(series);
  for (const ImportedMesh& mesh : {*list, *series, numbered}) {
    ASSERT_EQ(mesh.displacements.size(), 3U);
    EXPECT_TRUE(mesh.moves_points);
    for (std::size_t step = 0; step < 3; ++step) {
      EXPECT_EQ(mesh.displacements[step][0], (Point3{0, 0, 0}));
      EXPECT_EQ(mesh.displacements[step][4], (Point3{static_cast<double>(step), 0, 0}));
    }
  }
  EXPECT_EQ(list->times, (std::vector<double>{0.25, 0.5, 4}));
  EXPECT_EQ(series->times, list->times);
  EXPECT_EQ(numbered.times, (std::vector<double>{0, 1, 2}));
  EXPECT_FALSE(named.moves_points);
  EXPECT_EQ(named.displacements[1][4], (Point3{4, 8, 12}));

  const MeshReader reader(folder_ / "a.pvd", {.rest_step = 1});
  EXPECT_TRUE(reader.header().has_moving_points);
  EXPECT_EQ(reader.mesh().rest_positions[4], (Point3{2, 1, 1}));
  EXPECT_EQ(reader.read_step(2)[4], (Point3{3, 1, 1}));
  EXPECT_EQ(MeshReader(folder_ / "s_*.vtk").read_step(2)[4], (Point3{3, 1, 1}));
  for (const std::int64_t step : {-1, 3}) {
    for (const std::optional<std::string>& rest :
         {std::optional<std::string>(), std::optional<std::string>(folder_ / "s_*.vtk")}) {
      const std::string refusal =
          io_error([&] { MeshReader(folder_ / "a.pvd", {.rest_step = step, .rest_file = rest}); });
      EXPECT_NE(refusal.find("has no step " + std::to_string(step)), std::string::npos) << refusal;
    }
  }
}

TEST_F(MeshImport, RefusesDamagedSeriesInOneLine) {
  if (!imported("s.vtk", legacy_file())) GTEST_SKIP() << error;
  std::string other = legacy_file();
  other.replace(other.find("4 0 1 2 3"), 9, "4 0 1 2 4");
  std::ofstream(folder_ / "t.vtk") << other;
  const auto pvd = [](const std::string& entries) {
    return "<VTKFile type=\"Collection\"><Collection>" + entries + "</Collection></VTKFile>";
  };
  const struct {
    const char* name;
    std::string text;
    const char* expected;
  } cases[] = {
      {"a.pvd", "", "holds no <Collection>"},
      {"b.pvd", pvd(""), "lists no file"},
      {"c.pvd", pvd("<DataSet timestep=\"0\"/>"), "without a file"},
      {"d.pvd", pvd("<DataSet timestep=\"x\" file=\"s.vtk\"/>"), "no number"},
      {"e.pvd", pvd("<DataSet timestep=\"0\" file=\"none.vtk\"/>"), "a list of steps names it"},
      {"f.pvd", pvd("<DataSet timestep=\"0\" file=\"x.stl\"/>"), "a list of steps names it"},
      {"g.pvd",
       pvd("<DataSet timestep=\"0\" file=\"s.vtk\"/><DataSet timestep=\"1\" file=\"t.vtk\"/>"),
       "step 1 has other points or cells"},
      {"h.vtk.series", "{}", "no list 'files'"},
      {"i.vtk.series", R"({"files": [{"time": 1}]})", "without a name"},
      {"j.vtm", "<VTKFile", "no unstructured grid"},
      {"k.exo", "CDF", "no unstructured grid"},
  };
  for (const auto& bad : cases) {
    const std::string message = complaint(bad.name, bad.text);
    EXPECT_NE(message.find(bad.expected), std::string::npos) << bad.name << ": " << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
  EXPECT_NE(io_error([&] { import_mesh(folder_ / "none_*.vtk"); }).find("no file has such a name"),
            std::string::npos);
}

TEST_F(MeshImport, RefusesFilesOfVtkInOneLine) {
  std::string curved = legacy_file();
  curved.replace(curved.find("4 1 2 3 4\n"), 10, "6 0 1 2 3 0 1\n");
  curved.replace(curved.find("3 14"), 4, "3 16");
  curved.replace(curved.find("5\n10\n"), 5, "5\n25\n");
  std::string surface = legacy_file();
  surface.replace(surface.find("CELLS"), surface.find("POINT_DATA") - surface.find("CELLS"),
                  "CELLS 1 4\n3 1 2 3\nCELL_TYPES 1\n5\n");
  std::string short_cell = legacy_file();
  short_cell.replace(short_cell.find("4 0 1 2 3\n"), 10, "3 0 1 2\n");
  short_cell.replace(short_cell.find("3 14"), 4, "3 13");
  std::string stray_node = legacy_file();
  stray_node.replace(stray_node.find("4 1 2 3 4\n"), 10, "4 1 2 3 5\n");
  const std::string with_offsets =
      std::string("# vtk DataFile Version 5.1\nmesh\nASCII\nDATASET UNSTRUCTURED_GRID\n") +
      "POINTS 5 double\n" + mesh_points +
      "\nCELLS 3 8\nOFFSETS vtktypeint64\n0 4 99999999\nCONNECTIVITY vtktypeint64\n"
      "0 1 2 3 1 2 3 4\nCELL_TYPES 2\n10\n10\n";
  std::string no_number = legacy_file();
  no_number.replace(no_number.find("4 8 12"), 6, "4 8 x");
  expect_refusals({
      {"o.vtk", with_offsets, {}, "contradict each other: damaged"},
      {"q.vtk", no_number, {}, "no unstructured grid that VTK can read: damaged"},
      {"a.vtk", curved, {}, "cell 2 is a vtkQuadraticHexahedron"},
      {"b.vtk", surface, {}, "holds no tetrahedron"},
      {"s.vtk", short_cell, {}, "cell 0 does not have the nodes of a vtkTetra, each from 0 to 4"},
      {"t.vtk", stray_node, {}, "cell 2 does not have the nodes of a vtkTetra, each from 0 to 4"},
      {"c.vtk", legacy_file(), {.displacement = "u"}, "the file has heat, displacement"},
      {"d.vtk", legacy_file(), {.displacement = "heat"}, "three components"},
      {"e.vtk", "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\n", {}, "no unstructured"},
      {"f.vtu", xml_file().substr(0, 700), {}, "no unstructured grid"},
  });
  EXPECT_NE(complaint("j.xyz", "").find(".msh, .vtu, .vtk"), std::string::npos);
}
}  // namespace
}  // namespace tetwarp::test

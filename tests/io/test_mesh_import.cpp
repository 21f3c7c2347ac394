/// @file test_mesh_import.cpp
/// Meshes of other programs. In a build without the library the error is checked and tests skip.
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <tetwarp/io.hpp>
#include <tetwarp/mesh_import.hpp>
#include <tetwarp/warp.hpp>

#include "io/import/merge_cells.hpp"
#include "io/volume/mesh_arrays.hpp"
#include "tests/support/io_files.hpp"

namespace tetwarp::test {
namespace {
constexpr const char* points = "0 0 0  1 0 0  0 1 0  0 0 1  1 1 1";

/// The legacy format: two tetrahedra, a triangle between them, a displacement of (1, 2, 3) times
/// the node's number.
std::string legacy_file(const std::string& name = "displacement") {
  return std::string("# vtk DataFile Version 3.0\nmesh\nASCII\nDATASET UNSTRUCTURED_GRID\n") +
         "POINTS 5 double\n" + points +
         "\nCELLS 3 14\n4 0 1 2 3\n3 1 2 3\n4 1 2 3 4\nCELL_TYPES 3\n10\n5\n10\n"
         "POINT_DATA 5\nSCALARS heat double 1\nLOOKUP_TABLE default\n9 9 9 9 9\nVECTORS " +
         name + " double\n0 0 0  1 2 3  2 4 6  3 6 9  4 8 12\n";
}

/// The same in XML, in two steps of which the first has no displacement.
std::string xml_file() {
  const auto array = [](const std::string& attributes, const std::string& values) {
    return "<DataArray " + attributes + " format=\"ascii\">" + values + "</DataArray>";
  };
  const std::string vectors = "type=\"Float32\" NumberOfComponents=\"3\" Name=";
  return "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">"
         "<UnstructuredGrid TimeValues=\"0.5 2\">"
         "<Piece NumberOfPoints=\"5\" NumberOfCells=\"3\"><PointData>" +
         array(vectors + "\"displacement\" TimeStep=\"0\"", "0 0 0 0 0 0 0 0 0 0 0 0 0 0 0") +
         array(vectors + "\"displacement\" TimeStep=\"1\"", "0 0 0 1 2 3 2 4 6 3 6 9 4 8 12") +
         "</PointData><Points>" + array(vectors + "\"p\"", points) + "</Points><Cells>" +
         array("type=\"Int64\" Name=\"connectivity\"", "0 1 2 3 1 2 3 1 2 3 4") +
         array("type=\"Int64\" Name=\"offsets\"", "4 7 11") +
         array("type=\"UInt8\" Name=\"types\"", "10 5 10") +
         "</Cells></Piece></UnstructuredGrid></VTKFile>\n";
}

/// Node data of Gmsh at times 0.5 and 2; nodes bear the numbers 10, 20 to 50.
std::string node_data() {
  std::string text;
  for (const int step : {0, 1}) {
    text += "$NodeData\n1\n\"displacement\"\n1\n" + std::string(step == 0 ? "0.5" : "2") + "\n3\n" +
            std::to_string(step) + "\n3\n5\n";
    for (int n = 0; n < 5; ++n) {
      const int by = step * n;
      text += std::to_string(10 * (n + 1)) + " " + std::to_string(by) + " " +
              std::to_string(2 * by) + " " + std::to_string(3 * by) + "\n";
    }
    text += "$EndNodeData\n";
  }
  return text;
}

std::string msh2_file(const std::string& last_element = "8 4 2 0 1 20 30 40 50") {
  return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n"
         "10 0 0 0\n20 1 0 0\n30 0 1 0\n40 0 0 1\n50 1 1 1\n$EndNodes\n$Elements\n4\n"
         "5 15 2 0 1 10\n6 2 2 0 1 20 30 40\n7 4 2 0 1 10 20 30 40\n" +
         last_element + "\n$EndElements\n" + node_data();
}

std::string msh4_file() {
  return "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n1 0 1 1\n1 0 0 0 0\n1 0 0 0 1 1 1 0 "
         "0\n1 0 0 0 1 1 1 0 0\n$EndEntities\n$Nodes\n1 5 10 50\n3 1 0 5\n10\n20\n30\n40\n50\n"
         "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n$EndNodes\n$Elements\n3 4 5 8\n"
         "0 1 15 1\n5 10\n2 1 2 1\n6 20 30 40\n3 1 4 2\n7 10 20 30 40\n8 20 30 40 50\n"
         "$EndElements\n" +
         node_data();
}

class MeshImport : public ::testing::Test {
 protected:
  /// Nothing where this build lacks the library.
  std::optional<ImportedMesh> imported(const std::string& name,
                                       const std::string& text,
                                       const MeshImportOptions& options = {}) {
    std::ofstream(folder_ / name) << text;
    ImportedMesh mesh;
    error = io_error([&] { mesh = import_mesh(folder_ / name, options); });
    if (error.empty()) return mesh;
    if (error.find("this build cannot read") == std::string::npos) ADD_FAILURE() << error;
    return std::nullopt;
  }

  /// Empty where this build lacks the library.
  std::string complaint(const std::string& name,
                        const std::string& text,
                        const MeshImportOptions& options = {}) {
    std::ofstream(folder_ / name) << text;
    error = io_error([&] { import_mesh(folder_ / name, options); });
    return error.find("this build cannot read") == std::string::npos ? error : std::string();
  }

  std::string error;
  ScratchFolder folder_;
};

void expect_two_tets(const ImportedMesh& mesh) {
  EXPECT_EQ(mesh.mesh.rest_positions, two_tets().rest_positions);
  EXPECT_EQ(mesh.mesh.tets, two_tets().tets);
  ASSERT_EQ(mesh.displacements.size(), mesh.times.size());
  ASSERT_FALSE(mesh.displacements.empty());
  for (std::size_t n = 0; n < 5; ++n) {
    const auto by = static_cast<double>(n);
    EXPECT_EQ(mesh.displacements.back()[n], (Point3{by, 2 * by, 3 * by}));
  }
}

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

TEST_F(MeshImport, ReadsGmshFilesOfBothVersionsWithSteps) {
  for (const std::string& text : {msh2_file(), msh4_file()}) {
    const auto mesh = imported("a.msh", text);
    if (!mesh) GTEST_SKIP() << error;

    expect_two_tets(*mesh);
    EXPECT_EQ(mesh->times, (std::vector<double>{0.5, 2}));
    EXPECT_EQ(mesh->skipped.size(), 2U);
    for (const auto& [kind, count] : mesh->skipped) EXPECT_EQ(count, 1) << kind;
  }
}

/// In MSH 2 a cell of two physical groups is there twice.
TEST_F(MeshImport, MergesCellsOfTwoGroupsOfGmsh) {
  const auto mesh = imported(
      "a.msh",
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n"
      "$EndNodes\n$Elements\n2\n1 4 2 1 1 1 2 3 4\n2 4 2 2 1 1 2 3 4\n$EndElements\n");
  if (!mesh) GTEST_SKIP() << error;

  EXPECT_EQ(mesh->mesh.tets.size(), 1u);
  EXPECT_EQ(mesh->merged, "1 of 2 cells are there twice and were merged");
  for (const MeshArray& array : mesh->arrays) {
    if (array.is_of_cells) {
      EXPECT_EQ(array.data.size(), sizeof(std::int64_t)) << array.name;
    }
  }
}

std::vector<std::int64_t> numbers_of(const MeshArray& array) {
  std::vector<std::int64_t> numbers(array.data.size() / sizeof(std::int64_t));
  std::memcpy(numbers.data(), array.data.data(), array.data.size());
  return numbers;
}

/// The first of several has its own rows, and the groups of all.
TEST(MergeCells, KeepsTheFirstAndTheGroupsOfAll) {
  ImportedMesh mesh;
  mesh.mesh.rest_positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  mesh.mesh.tets = {{0, 1, 2, 3}, {1, 2, 3, 4}, {3, 2, 1, 0}, {0, 2, 1, 3}};
  mesh.mesh.hexes = {{0, 1, 2, 3, 4, 1, 2, 3}};
  add_numbers("group", true, {7, 8, 9, 7, 5}, mesh);
  mesh.arrays[0].value_names = {{7, "seven"}, {9, "nine"}};
  add_numbers("original_cell", true, {10, 11, 12, 13, 14}, mesh);
  add_numbers("original_node", false, {0, 1, 2, 3, 4}, mesh);

  merge_cells(mesh);

  EXPECT_EQ(mesh.mesh.tets.size(), 2u);
  EXPECT_EQ(mesh.mesh.hexes.size(), 1u);
  EXPECT_EQ(mesh.merged, "2 of 5 cells are there twice and were merged");
  ASSERT_EQ(mesh.arrays.size(), 4u);
  EXPECT_EQ(numbers_of(mesh.arrays[0]), (std::vector<std::int64_t>{7, 8, 5}));
  EXPECT_EQ(numbers_of(mesh.arrays[1]), (std::vector<std::int64_t>{10, 11, 14}));
  EXPECT_EQ(numbers_of(mesh.arrays[2]), (std::vector<std::int64_t>{0, 1, 2, 3, 4}));
  EXPECT_EQ(mesh.arrays[3].name, "group_2");
  EXPECT_EQ(numbers_of(mesh.arrays[3]), (std::vector<std::int64_t>{9, 0, 0}));
  EXPECT_EQ(mesh.arrays[3].value_names, mesh.arrays[0].value_names);
}

/// Half a turn about z; cells keep their orientation.
TEST_F(MeshImport, TurnsMeshesFromLpsToRas) {
  for (const auto& [name, text] :
       {std::pair{"a.vtk", legacy_file()}, {"b.vtu", xml_file()}, {"c.msh", msh4_file()}}) {
    const auto mesh = imported(name, text, {.axes = Axes::lps});
    if (!mesh) continue;
    EXPECT_EQ(mesh->mesh.rest_positions[4], (Point3{-1, -1, 1})) << name;
    EXPECT_EQ(mesh->mesh.tets, two_tets().tets) << name;
    EXPECT_EQ(mesh->displacements.back()[2], (Point3{-2, -4, 6})) << name;
  }
}

/// A unit cube in Gmsh's numbers and in VTK's, which have one order.
TEST_F(MeshImport, KeepsHexahedra) {
  const std::string corners = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n";
  std::string numbered;
  for (std::size_t n = 0; n < 8; ++n) {
    numbered += std::to_string(n + 1) + " " + corners.substr(6 * n, 6);
  }
  const auto gmsh =
      imported("a.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n" + numbered +
                            "$EndNodes\n$Elements\n1\n1 5 2 0 1 1 2 3 4 5 6 7 8\n"
                            "$EndElements\n");
  const auto vtk = imported("b.vtk",
                            "# vtk DataFile Version 3.0\ncube\nASCII\nDATASET UNSTRUCTURED_GRID\n"
                            "POINTS 8 float\n" +
                                corners + "CELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n12\n");
  if (!gmsh && !vtk) GTEST_SKIP() << error;

  for (const auto& mesh : {gmsh, vtk}) {
    if (!mesh) continue;
    EXPECT_EQ(mesh->mesh.hexes,
              (std::vector<std::array<std::int32_t, 8>>{{0, 1, 2, 3, 4, 5, 6, 7}}));
    EXPECT_EQ(mesh->mesh.rest_positions[6], (Point3{1, 1, 1}));
  }
}

/// msh4_file() with a sixth node that no cell has.
std::string with_stray_node() {
  std::string text = msh4_file();
  const std::string nodes = "1 5 10 50\n3 1 0 5\n", last = "1 1 1\n$EndNodes";
  text.replace(text.find(nodes), nodes.size(), "1 6 10 60\n3 1 0 6\n");
  text.replace(text.find("50\n0 0 0\n"), 3, "50\n60\n");
  return text.replace(text.find(last), 6, "1 1 1\n9 9 9\n");
}

/// Nodes of no cell need no data, and what they have moves nothing. Others need all.
TEST_F(MeshImport, TakesDataOfTheNodesThatCellsHave) {
  const auto partial = imported("a.msh", with_stray_node());
  if (!partial) GTEST_SKIP() << error;
  std::string text = with_stray_node();
  const std::string rows = "3\n0\n3\n5\n";
  text.replace(text.find(rows), rows.size(), "3\n0\n3\n6\n60 nan nan nan\n");
  const auto no_number = imported("b.msh", text);
  std::string lacking = with_stray_node();
  lacking.replace(lacking.find(rows), rows.size(), "3\n0\n3\n4\n");
  lacking.replace(lacking.find("50 0 0 0\n$End"), 9, "");
  const std::string message = complaint("c.msh", lacking);

  std::string old = msh2_file();
  old.replace(old.find("$EndNodes"), 0, "60 9 9 9\n");
  old.replace(old.find("$Nodes\n5"), 8, "$Nodes\n6");
  const auto lost = imported("d.msh", old);

  ASSERT_TRUE(lost);
  EXPECT_EQ(lost->left_out, std::vector<std::string>{"1 nodes of no cell"});
  for (const auto& mesh : {partial, no_number}) {
    ASSERT_TRUE(mesh);
    ASSERT_EQ(mesh->mesh.rest_positions.size(), 6U);
    EXPECT_EQ(mesh->mesh.tets, two_tets().tets);
    EXPECT_EQ(mesh->displacements.back()[4], (Point3{4, 8, 12}));
    for (const auto& step : mesh->displacements) EXPECT_EQ(step[5], (Point3{0, 0, 0}));
  }
  EXPECT_NE(message.find("step 0 has no data of node 50, which cells have"), std::string::npos)
      << message;
}

/// The readers run in a fork of this process, in which its other threads are missing.
TEST_F(MeshImport, WorksBesideOtherThreads) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP()
      << "the allocator of g++ 12's address sanitizer hangs in a child forked beside threads";
#endif
  Volume volume = counting_volume(PixelType::float32);
  volume.grid.direction = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  warp(volume, two_tets(), two_tets().rest_positions, {.threads = 3});

  for (const auto& [name, text] :
       {std::pair{"a.vtk", legacy_file()}, {"b.vtu", xml_file()}, {"c.msh", msh4_file()}}) {
    const auto mesh = imported(name, text, {.displacement = {}, .time_limit = 60});
    if (mesh) expect_two_tets(*mesh);
  }
}

/// Cells of VTK by their types, all with the nodes 0, 1, 2 and so on of `places`.
std::string legacy_cells(const std::string& places,
                         int place_count,
                         const std::vector<std::pair<int, int>>& types) {
  std::string cells, list;
  int numbers = 0;
  for (const auto& [type, count] : types) {
    cells += std::to_string(count);
    for (int n = 0; n < count; ++n) cells += " " + std::to_string(n);
    cells += "\n";
    list += std::to_string(type) + "\n";
    numbers += count + 1;
  }
  const std::string amount = std::to_string(types.size());
  return "# vtk DataFile Version 3.0\ncells\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " +
         std::to_string(place_count) + " double\n" + places + "\nCELLS " + amount + " " +
         std::to_string(numbers) + "\n" + cells + "CELL_TYPES " + amount + "\n" + list;
}

/// Signed volume of a tetrahedron, times six.
double volume6_of(const Mesh& mesh, const std::array<std::int32_t, 4>& tet) {
  const auto side = [&](std::size_t a, std::size_t axis) {
    const auto at = [&](std::size_t n) {
      return mesh.rest_positions[static_cast<std::size_t>(tet[n])][axis];
    };
    return at(a) - at(0);
  };
  double volume = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t next = (axis + 1) % 3, last = (axis + 2) % 3;
    volume += side(1, axis) * (side(2, next) * side(3, last) - side(2, last) * side(3, next));
  }
  return volume;
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

/// The eight parts fill the cell, as the four nodes of its corners do, in their orientation.
TEST_F(MeshImport, CutsTetrahedraOfTenNodesAtTheirNodes) {
  const auto vtk = imported(
      "a.vtk",
      legacy_cells("0 0 0 2 0 0 0 2 0 0 0 2 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 0 1 1", 10, {{24, 10}}));
  const auto gmsh = imported(
      "b.msh",
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n10\n1 0 0 0\n2 2 0 0\n3 0 2 0\n4 0 0 2\n"
      "5 1 0 0\n6 1 1 0\n7 0 1 0\n8 0 0 1\n9 0 1 1\n10 1 0 1\n$EndNodes\n$Elements\n1\n"
      "1 11 2 0 1 1 2 3 4 5 6 7 8 9 10\n$EndElements\n");
  for (const auto& mesh : {vtk, gmsh}) {
    if (!mesh) continue;
    ASSERT_EQ(mesh->mesh.tets.size(), 8U);
    double sum = 0;
    for (const auto& tet : mesh->mesh.tets) {
      EXPECT_DOUBLE_EQ(volume6_of(mesh->mesh, tet), 1);
      sum += volume6_of(mesh->mesh, tet);
    }
    EXPECT_DOUBLE_EQ(sum, 8);
  }
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

TEST_F(MeshImport, RefusesWhatItCannotReadInOneLine) {
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
      "POINTS 5 double\n" + points +
      "\nCELLS 3 8\nOFFSETS vtktypeint64\n0 4 99999999\nCONNECTIVITY vtktypeint64\n"
      "0 1 2 3 1 2 3 4\nCELL_TYPES 2\n10\n10\n";
  std::string twin = msh2_file();
  twin.replace(twin.find("50 1 1 1"), 2, "40");
  std::string negative_node = msh4_file();
  negative_node.replace(negative_node.find("8 20 30 40"), 10, "8 20 30 -40");
  std::string no_number = legacy_file();
  no_number.replace(no_number.find("4 8 12"), 6, "4 8 x");
  const struct {
    const char* name;
    std::string text;
    MeshImportOptions options;
    const char* expected;
  } cases[] = {
      {"o.vtk", with_offsets, {}, "contradict each other: damaged"},
      {"p.msh", twin, {}, "Gmsh cannot read it: Wrong node index 50"},
      {"r.msh", negative_node, {}, "read"},  // Gmsh 4.8 crashes
      {"q.vtk", no_number, {}, "no unstructured grid that VTK can read: damaged"},
      {"a.vtk", curved, {}, "cell 2 is a vtkQuadraticHexahedron"},
      {"b.vtk", surface, {}, "holds no tetrahedron"},
      {"s.vtk", short_cell, {}, "cell 0 does not have the nodes of a vtkTetra, each from 0 to 4"},
      {"t.vtk", stray_node, {}, "cell 2 does not have the nodes of a vtkTetra, each from 0 to 4"},
      {"c.vtk", legacy_file(), {.displacement = "u"}, "the file has heat, displacement"},
      {"d.vtk", legacy_file(), {.displacement = "heat"}, "three components"},
      {"e.vtk", "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\n", {}, "no unstructured"},
      {"f.vtu", xml_file().substr(0, 700), {}, "no unstructured grid"},
      {"g.msh", "SystemCall \"true\";\n", {}, "does not begin with $MeshFormat"},
      {"h.msh",
       msh2_file("8 19 2 0 1 10 20 30 40 50 10 20 30 40 50 10 20 30"),
       {},
       "cell 8 is a Pyramid"},
      {"i.msh", msh2_file(), {.displacement = "u"}, "the file has displacement"},
  };
  for (const auto& bad : cases) {
    const std::string message = complaint(bad.name, bad.text, bad.options);
    if (message.empty()) {
      EXPECT_NE(error.find("install lib"), std::string::npos) << error;
      continue;
    }
    EXPECT_NE(message.find(bad.expected), std::string::npos) << bad.name << ": " << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
  EXPECT_NE(complaint("j.xyz", "").find(".msh, .vtu, .vtk"), std::string::npos);
}
}  // namespace
}  // namespace tetwarp::test

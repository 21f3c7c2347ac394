/// @file test_mesh_import.cpp
/// Meshes of other programs, in whichever format. In a build without the library the error is
/// checked and tests skip.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <tetwarp/mesh_import.hpp>
#include <tetwarp/warp.hpp>

#include "io/import/merge_cells.hpp"
#include "io/import/split_cells.hpp"
#include "io/volume/mesh_arrays.hpp"
#include "tests/support/curved_scenes.hpp"
#include "tests/support/mesh_files.hpp"

namespace tetwarp::test {
namespace {
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

/// A straight tetrahedron of ten nodes, whose last two Gmsh has in the other order.
std::string ten_nodes_of_vtk() {
  return legacy_cells("0 0 0 2 0 0 0 2 0 0 0 2 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 0 1 1", 10,
                      {{24, 10}});
}
std::string ten_nodes_of_gmsh() {
  return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n10\n1 0 0 0\n2 2 0 0\n3 0 2 0\n4 0 0 2\n"
         "5 1 0 0\n6 1 1 0\n7 0 1 0\n8 0 0 1\n9 0 1 1\n10 1 0 1\n$EndNodes\n$Elements\n1\n"
         "1 11 2 0 1 1 2 3 4 5 6 7 8 9 10\n$EndElements\n";
}

TEST_F(MeshImport, KeepsTetrahedraOfTenNodesInTheOrderOfVtk) {
  for (const auto& mesh : {imported("a.vtk", ten_nodes_of_vtk(), {.keeps_curved = true}),
                           imported("b.msh", ten_nodes_of_gmsh(), {.keeps_curved = true})}) {
    if (!mesh) continue;
    ASSERT_EQ(mesh->mesh.tets.size(), 1U);
    ASSERT_EQ(mesh->mid_nodes.size(), 1U);
    const auto place = [&](std::int32_t node) {
      return mesh->mesh.rest_positions[static_cast<std::size_t>(node)];
    };
    for (std::size_t e = 0; e < 6; ++e) {
      const Point3 a = place(mesh->mesh.tets[0][ends_of_edges[e][0]]);
      const Point3 b = place(mesh->mesh.tets[0][ends_of_edges[e][1]]);
      EXPECT_EQ(place(mesh->mid_nodes[0][e]),
                (Point3{(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2}));
    }
  }
}

/// Rows of arrays are repeated for the parts.
TEST(SplitCells, GivesPartsTheRowsOfTheirCell) {
  ImportedMesh mesh;
  mesh.mesh.rest_positions.resize(14);
  mesh.mesh.tets = {{0, 1, 2, 3}, {0, 1, 2, 4}, {10, 11, 12, 13}};
  mesh.mesh.hexes = {{0, 1, 2, 3, 4, 5, 6, 7}};
  mesh.mid_nodes = {no_mid_nodes, {4, 5, 6, 7, 8, 9}, no_mid_nodes};
  add_numbers("group", true, {7, 8, 9, 5}, mesh);
  add_numbers("original_node", false, std::vector<std::int64_t>(14, 1), mesh);

  split_curved_cells(mesh);

  EXPECT_TRUE(mesh.mid_nodes.empty());
  EXPECT_EQ(mesh.mesh.tets.size(), 10U);
  EXPECT_EQ(mesh.mesh.tets[1], (std::array<std::int32_t, 4>{0, 4, 6, 7}));
  EXPECT_EQ(mesh.mesh.tets[9], (std::array<std::int32_t, 4>{10, 11, 12, 13}));
  EXPECT_EQ(numbers_of(mesh.arrays[0]),
            (std::vector<std::int64_t>{7, 8, 8, 8, 8, 8, 8, 8, 8, 9, 5}));
  EXPECT_EQ(numbers_of(mesh.arrays[1]).size(), 14U);
}

/// The eight parts fill the cell, as the four nodes of its corners do, in their orientation.
TEST_F(MeshImport, CutsTetrahedraOfTenNodesAtTheirNodes) {
  for (const auto& mesh :
       {imported("a.vtk", ten_nodes_of_vtk()), imported("b.msh", ten_nodes_of_gmsh())}) {
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
}  // namespace
}  // namespace tetwarp::test

/// @file test_mesh_import_gmsh.cpp
/// Meshes of Gmsh. In a build without it the error is checked and tests skip.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/mesh_import.hpp>

#include "tests/support/mesh_files.hpp"

namespace tetwarp::test {
namespace {
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

TEST_F(MeshImport, RefusesFilesOfGmshInOneLine) {
  std::string twin = msh2_file();
  twin.replace(twin.find("50 1 1 1"), 2, "40");
  std::string negative_node = msh4_file();
  negative_node.replace(negative_node.find("8 20 30 40"), 10, "8 20 30 -40");
  expect_refusals({
      {"p.msh", twin, {}, "Gmsh cannot read it: Wrong node index 50"},
      {"r.msh", negative_node, {}, "read"},  // Gmsh 4.8 crashes
      {"g.msh", "SystemCall \"true\";\n", {}, "does not begin with $MeshFormat"},
      {"h.msh",
       msh2_file("8 19 2 0 1 10 20 30 40 50 10 20 30 40 50 10 20 30"),
       {},
       "cell 8 is a Pyramid"},
      {"i.msh", msh2_file(), {.displacement = "u"}, "the file has displacement"},
  });
}
}  // namespace
}  // namespace tetwarp::test

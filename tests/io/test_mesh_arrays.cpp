/// @file test_mesh_arrays.cpp
/// Arrays, groups and numbers of imported meshes. Without the library of a format its test skips.
#include <gtest/gtest.h>
#include <malloc.h>

#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <tetwarp/mesh_import.hpp>

#include "tests/support/io_files.hpp"

namespace tetwarp::test {
namespace {
/// Nothing, and why in `error`, where this build lacks the library.
std::optional<ImportedMesh> mesh_of(const std::string& path,
                                    const std::string& text,
                                    std::string& error,
                                    const MeshImportOptions& options = {}) {
  std::ofstream(path) << text;
  ImportedMesh mesh;
  error = io_error([&] { mesh = import_mesh(path, options); });
  if (error.empty()) return mesh;
  EXPECT_NE(error.find("this build cannot read"), std::string::npos) << error;
  return std::nullopt;
}

/// The array of a name; its samples as doubles. Empty where there is none.
std::vector<double> array_of(const ImportedMesh& mesh, const std::string& name, bool is_of_cells) {
  for (const MeshArray& array : mesh.arrays) {
    if (array.name != name || array.is_of_cells != is_of_cells) continue;
    const auto copy = [&]<class T>(T) {
      const T* const first = reinterpret_cast<const T*>(array.data.data());
      return std::vector<double>(first, first + array.data.size() / sizeof(T));
    };
    if (array.type == PixelType::int64) return copy(std::int64_t{});
    if (array.type == PixelType::int32) return copy(std::int32_t{});
    return array.type == PixelType::float32 ? copy(float{}) : copy(double{});
  }
  return {};
}

/// A hexahedron, a triangle and a tetrahedron on it, with arrays of both kinds.
constexpr const char* mixed_file =
    "# vtk DataFile Version 3.0\nmixed\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 9 float\n"
    "0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1 0 0 2\n"
    "CELLS 3 18\n8 0 1 2 3 4 5 6 7\n3 4 5 8\n4 4 5 7 8\nCELL_TYPES 3\n12\n5\n10\n"
    "CELL_DATA 3\nSCALARS material int 1\nLOOKUP_TABLE default\n7 8 9\n"
    "POINT_DATA 9\nSCALARS heat double 1\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 7 8\n"
    "VECTORS flow float\n1 2 3 1 2 3 1 2 3 1 2 3 1 2 3 1 2 3 1 2 3 1 2 3 1 2 3\n"
    "FIELD FieldData 1\na.b 1 9 float\n0 0 0 0 0 0 0 0 0\n";

/// Tetrahedra come first in a mesh; arrays and numbers follow their cells.
TEST(MeshArrays, OfVtkFilesFollowTheirCellsAndVectorsTurn) {
  const ScratchFolder folder;
  std::string error;
  const auto mesh = mesh_of(folder / "a.vtk", mixed_file, error, {.axes = Axes::lps});
  if (!mesh) GTEST_SKIP() << error;

  EXPECT_EQ(mesh->mesh.tets, (std::vector<std::array<std::int32_t, 4>>{{4, 5, 7, 8}}));
  EXPECT_EQ(array_of(*mesh, "original_cell", true), (std::vector<double>{2, 0}));
  EXPECT_EQ(array_of(*mesh, "material", true), (std::vector<double>{9, 7}));
  EXPECT_EQ(array_of(*mesh, "heat", false), (std::vector<double>{0, 1, 2, 3, 4, 5, 6, 7, 8}));
  std::vector<double> flow = array_of(*mesh, "flow", false);
  ASSERT_EQ(flow.size(), 27U);
  flow.resize(3);
  EXPECT_EQ(flow, (std::vector<double>{-1, -2, 3}));
  EXPECT_EQ(mesh->left_out, std::vector<std::string>{"point array 'a.b'"});
}

/// Tags 10 to 50 of nodes, 7 and 8 of cells, which belong to the groups 3 and 5.
TEST(MeshArrays, OfGmshFilesHoldTagsAndGroups) {
  const ScratchFolder folder;
  std::string error;
  const auto mesh =
      mesh_of(folder / "a.msh",
              "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
              "$PhysicalNames\n1\n3 3 \"bone\"\n$EndPhysicalNames\n"
              "$Nodes\n5\n10 0 0 0\n20 1 0 0\n30 0 1 0\n40 0 0 1\n50 1 1 1\n$EndNodes\n"
              "$Elements\n3\n6 2 2 0 1 20 30 40\n7 4 2 3 1 10 20 30 40\n8 4 2 5 2 20 30 40 50\n"
              "$EndElements\n",
              error);
  if (!mesh) GTEST_SKIP() << error;

  EXPECT_EQ(array_of(*mesh, "original_node", false), (std::vector<double>{10, 20, 30, 40, 50}));
  EXPECT_EQ(array_of(*mesh, "original_cell", true), (std::vector<double>{7, 8}));
  EXPECT_EQ(array_of(*mesh, "group", true), (std::vector<double>{3, 5}));
  EXPECT_TRUE(mesh->left_out.empty());
  write_mesh(folder / "a.vtkhdf", mesh->mesh, {}, {}, mesh->arrays);
  const std::map<std::int64_t, std::string> names{{3, "bone"}};
  EXPECT_EQ(MeshReader(folder / "a.vtkhdf").header().group_names, names);
  EXPECT_EQ(MeshReader(folder / "a.msh").header().group_names, names);
}

/// HDF5 must not use what it has freed: freed memory is overwritten here.
TEST(MeshArrays, AFileIsClosedWhileItsDriverExists) {
  const ScratchFolder folder;
  mallopt(M_PERTURB, 165);
  write_mesh(folder / "m.vtkhdf", two_tets());
  mallopt(M_PERTURB, 0);

  EXPECT_EQ(MeshReader(folder / "m.vtkhdf").mesh().tets, two_tets().tets);
}

/// What does not fit into an attribute of HDF5 is refused; line breaks would make other names.
TEST(MeshArrays, NamesOfValuesAreChecked) {
  const ScratchFolder folder;
  MeshArray group{"group", true, PixelType::int64, 1, std::vector<std::byte>(16)};
  const auto write = [&](const std::string& name) {
    group.value_names = {{-5, name}, {7, "soft tissue"}};
    return io_error([&] { write_mesh(folder / "m.vtkhdf", two_tets(), {}, {}, {group}); });
  };

  EXPECT_NE(write(std::string(60000, 'a')).find("group: the names of its values take 600"),
            std::string::npos);
  EXPECT_EQ(folder.entry_count(), 0);
  EXPECT_EQ(write("a\nb"), "");
  EXPECT_EQ(MeshReader(folder / "m.vtkhdf").header().group_names,
            (std::map<std::int64_t, std::string>{{-5, "a b"}, {7, "soft tissue"}}));
}

TEST(MeshArrays, AreWrittenBesideTheStepsAndCheckedBefore) {
  const ScratchFolder folder;
  const Mesh mesh = two_tets();
  const MeshArray material{"material", true, PixelType::uint8, 1, std::vector<std::byte>(2)};
  const MeshArray flow{"flow", false, PixelType::float32, 3, std::vector<std::byte>(60)};

  write_mesh(folder / "m.vtkhdf", mesh, slides({0, 1}), {0, 1}, {material, flow});

  EXPECT_EQ(MeshReader(folder / "m.vtkhdf").mesh().tets, mesh.tets);
  EXPECT_EQ(MeshReader(folder / "m.vtkhdf").read_step(1)[0], (Point3{1, 0, 0}));
  const auto error = [&](const std::vector<MeshArray>& arrays) {
    return io_error([&] { write_mesh(folder / "n.vtkhdf", mesh, {}, {}, arrays); });
  };
  EXPECT_NE(error({material, material}).find("must be unique"), std::string::npos);
  MeshArray short_flow = flow;
  short_flow.data.pop_back();
  EXPECT_NE(error({short_flow}).find("flow: has 59 bytes, expected 5 rows"), std::string::npos);
  EXPECT_EQ(folder.entry_count(), 1);
}
}  // namespace
}  // namespace tetwarp::test

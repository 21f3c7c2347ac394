/// @file mesh_files.hpp
/// Small meshes as files of VTK and Gmsh, and what importing them gives.
#pragma once
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <tetwarp/io.hpp>
#include <tetwarp/mesh_import.hpp>

#include "tests/support/io_files.hpp"

namespace tetwarp::test {

inline constexpr const char* mesh_points = "0 0 0  1 0 0  0 1 0  0 0 1  1 1 1";

/// The legacy format: two tetrahedra, a triangle between them, a displacement of (1, 2, 3) times
/// the node's number.
inline std::string legacy_file(const std::string& name = "displacement") {
  return std::string("# vtk DataFile Version 3.0\nmesh\nASCII\nDATASET UNSTRUCTURED_GRID\n") +
         "POINTS 5 double\n" + mesh_points +
         "\nCELLS 3 14\n4 0 1 2 3\n3 1 2 3\n4 1 2 3 4\nCELL_TYPES 3\n10\n5\n10\n"
         "POINT_DATA 5\nSCALARS heat double 1\nLOOKUP_TABLE default\n9 9 9 9 9\nVECTORS " +
         name + " double\n0 0 0  1 2 3  2 4 6  3 6 9  4 8 12\n";
}

/// The same in XML, in two steps of which the first has no displacement.
inline std::string xml_file() {
  const auto array = [](const std::string& attributes, const std::string& values) {
    return "<DataArray " + attributes + " format=\"ascii\">" + values + "</DataArray>";
  };
  const std::string vectors = "type=\"Float32\" NumberOfComponents=\"3\" Name=";
  return "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">"
         "<UnstructuredGrid TimeValues=\"0.5 2\">"
         "<Piece NumberOfPoints=\"5\" NumberOfCells=\"3\"><PointData>" +
         array(vectors + "\"displacement\" TimeStep=\"0\"", "0 0 0 0 0 0 0 0 0 0 0 0 0 0 0") +
         array(vectors + "\"displacement\" TimeStep=\"1\"", "0 0 0 1 2 3 2 4 6 3 6 9 4 8 12") +
         "</PointData><Points>" + array(vectors + "\"p\"", mesh_points) + "</Points><Cells>" +
         array("type=\"Int64\" Name=\"connectivity\"", "0 1 2 3 1 2 3 1 2 3 4") +
         array("type=\"Int64\" Name=\"offsets\"", "4 7 11") +
         array("type=\"UInt8\" Name=\"types\"", "10 5 10") +
         "</Cells></Piece></UnstructuredGrid></VTKFile>\n";
}

/// Node data of Gmsh at times 0.5 and 2; nodes bear the numbers 10, 20 to 50.
inline std::string node_data() {
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

/// Cells of VTK by their types, all with the nodes 0, 1, 2 and so on of `places`.
inline std::string legacy_cells(const std::string& places,
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

inline std::string msh2_file(const std::string& last_element = "8 4 2 0 1 20 30 40 50") {
  return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n"
         "10 0 0 0\n20 1 0 0\n30 0 1 0\n40 0 0 1\n50 1 1 1\n$EndNodes\n$Elements\n4\n"
         "5 15 2 0 1 10\n6 2 2 0 1 20 30 40\n7 4 2 0 1 10 20 30 40\n" +
         last_element + "\n$EndElements\n" + node_data();
}

inline std::string msh4_file() {
  return "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n1 0 1 1\n1 0 0 0 0\n1 0 0 0 1 1 1 0 "
         "0\n1 0 0 0 1 1 1 0 0\n$EndEntities\n$Nodes\n1 5 10 50\n3 1 0 5\n10\n20\n30\n40\n50\n"
         "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n$EndNodes\n$Elements\n3 4 5 8\n"
         "0 1 15 1\n5 10\n2 1 2 1\n6 20 30 40\n3 1 4 2\n7 10 20 30 40\n8 20 30 40 50\n"
         "$EndElements\n" +
         node_data();
}

/// A text that is no mesh, and a part of the line that says so.
struct BadMeshFile {
  const char* name;
  std::string text;
  MeshImportOptions options;
  const char* expected;
};

/// Imports texts as files.
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

  void expect_refusals(const std::vector<BadMeshFile>& files) {
    for (const BadMeshFile& bad : files) {
      const std::string message = complaint(bad.name, bad.text, bad.options);
      if (message.empty()) {
        EXPECT_NE(error.find("install lib"), std::string::npos) << error;
        continue;
      }
      EXPECT_NE(message.find(bad.expected), std::string::npos) << bad.name << ": " << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
  }

  std::string error;
  ScratchFolder folder_;
};

inline void expect_two_tets(const ImportedMesh& mesh) {
  EXPECT_EQ(mesh.mesh.rest_positions, two_tets().rest_positions);
  EXPECT_EQ(mesh.mesh.tets, two_tets().tets);
  ASSERT_EQ(mesh.displacements.size(), mesh.times.size());
  ASSERT_FALSE(mesh.displacements.empty());
  for (std::size_t n = 0; n < 5; ++n) {
    const auto by = static_cast<double>(n);
    EXPECT_EQ(mesh.displacements.back()[n], (Point3{by, 2 * by, 3 * by}));
  }
}

inline std::vector<std::int64_t> numbers_of(const MeshArray& array) {
  std::vector<std::int64_t> numbers(array.data.size() / sizeof(std::int64_t));
  std::memcpy(numbers.data(), array.data.data(), array.data.size());
  return numbers;
}

}  // namespace tetwarp::test

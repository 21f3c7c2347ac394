/// @file fuzz_mesh_files.hpp
/// One mesh in the formats of other programs: two tetrahedra, a triangle, a displacement.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace tetwarp::test {

struct ForeignMesh {
  std::string format;  ///< for the command line
  std::string name;    ///< of the file
  std::string content;
};

/// The bytes of a number, the first one the least significant, or the most.
template <class T>
std::string packed(const std::vector<T>& numbers, bool is_big_endian = false) {
  std::string all;
  for (const T& number : numbers) {
    std::string bytes(sizeof(T), '\0');
    std::memcpy(bytes.data(), &number, sizeof(T));
    if (is_big_endian) std::reverse(bytes.begin(), bytes.end());
    all += bytes;
  }
  return all;
}

inline const std::vector<double> mesh_points = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
inline const std::vector<double> mesh_shifts = {0, 0, 0, 1, 2, 3, 2, 4, 6, 3, 6, 9, 4, 8, 12};

template <class T>
std::string text_of_numbers(const std::vector<T>& numbers) {
  std::string text;
  for (const T& number : numbers) text += std::to_string(number) + " ";
  return text + "\n";
}

inline std::string legacy_head(const std::string& version, const std::string& coding) {
  return "# vtk DataFile Version " + version + "\nmesh\n" + coding +
         "\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n";
}

inline const std::string legacy_fields =
    "CELL_DATA 3\nSCALARS part int 1\nLOOKUP_TABLE default\n1 2 3\nFIELD f 1\nid 1 3 int\n5 6 7\n";

inline std::string legacy_text() {
  return legacy_head("3.0", "ASCII") + text_of_numbers(mesh_points) +
         "CELLS 3 14\n4 0 1 2 3\n3 1 2 3\n4 1 2 3 4\nCELL_TYPES 3\n10\n5\n10\n" + legacy_fields +
         "POINT_DATA 5\nVECTORS displacement double\n" + text_of_numbers(mesh_shifts);
}

inline std::string legacy_text_with_offsets() {
  return legacy_head("5.1", "ASCII") + text_of_numbers(mesh_points) +
         "CELLS 4 11\nOFFSETS vtktypeint64\n0 4 7 11\nCONNECTIVITY vtktypeint64\n"
         "0 1 2 3 1 2 3 1 2 3 4\nCELL_TYPES 3\n10\n5\n10\n" +
         legacy_fields + "POINT_DATA 5\nVECTORS displacement double\n" +
         text_of_numbers(mesh_shifts);
}

inline std::string legacy_binary() {
  return legacy_head("3.0", "BINARY") + packed(mesh_points, true) + "\nCELLS 3 14\n" +
         packed<std::int32_t>({4, 0, 1, 2, 3, 3, 1, 2, 3, 4, 1, 2, 3, 4}, true) +
         "\nCELL_TYPES 3\n" + packed<std::int32_t>({10, 5, 10}, true) +
         "\nPOINT_DATA 5\nVECTORS displacement double\n" + packed(mesh_shifts, true) + "\n";
}

inline std::string legacy_binary_with_offsets() {
  return legacy_head("5.1", "BINARY") + packed(mesh_points, true) +
         "\nCELLS 4 11\nOFFSETS vtktypeint64\n" + packed<std::int64_t>({0, 4, 7, 11}, true) +
         "\nCONNECTIVITY vtktypeint64\n" +
         packed<std::int64_t>({0, 1, 2, 3, 1, 2, 3, 1, 2, 3, 4}, true) + "\nCELL_TYPES 3\n" +
         packed<std::int32_t>({10, 5, 10}, true) + "\nPOINT_DATA 5\nVECTORS displacement double\n" +
         packed(mesh_shifts, true) + "\n";
}

/// XML with its numbers in the text, or as raw bytes behind it.
inline std::string xml_mesh(bool is_appended) {
  std::string appended;
  const auto array = [&](const std::string& attributes, const std::string& text,
                         const std::string& bytes) {
    if (!is_appended) {
      return "<DataArray " + attributes + " format=\"ascii\">" + text + "</DataArray>\n";
    }
    const std::string at = std::to_string(appended.size());
    appended += packed<std::uint64_t>({bytes.size()}) + bytes;
    return "<DataArray " + attributes + " format=\"appended\" offset=\"" + at + "\"/>\n";
  };
  const std::vector<std::int64_t> nodes = {0, 1, 2, 3, 1, 2, 3, 1, 2, 3, 4}, ends = {4, 7, 11};
  const std::vector<std::uint8_t> types = {10, 5, 10};
  const std::string vectors = "type=\"Float64\" NumberOfComponents=\"3\" Name=";
  const std::string pieces =
      "<Piece NumberOfPoints=\"5\" NumberOfCells=\"3\">\n<PointData>\n" +
      array(vectors + "\"displacement\"", text_of_numbers(mesh_shifts), packed(mesh_shifts)) +
      "</PointData>\n<CellData>\n" +
      array("type=\"UInt8\" Name=\"part\"", text_of_numbers(types), packed(types)) +
      "</CellData>\n<Points>\n" +
      array(vectors + "\"p\"", text_of_numbers(mesh_points), packed(mesh_points)) +
      "</Points>\n<Cells>\n" +
      array("type=\"Int64\" Name=\"connectivity\"", text_of_numbers(nodes), packed(nodes)) +
      array("type=\"Int64\" Name=\"offsets\"", text_of_numbers(ends), packed(ends)) +
      array("type=\"UInt8\" Name=\"types\"", text_of_numbers(types), packed(types)) +
      "</Cells>\n</Piece>\n";
  return "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
         "header_type=\"UInt64\">\n<UnstructuredGrid>\n" +
         pieces + "</UnstructuredGrid>\n" +
         (is_appended ? "<AppendedData encoding=\"raw\">\n_" + appended + "\n</AppendedData>\n"
                      : "") +
         "</VTKFile>\n";
}

inline std::string gmsh_node_data() {
  std::string text = "$NodeData\n1\n\"displacement\"\n1\n0.5\n3\n0\n3\n5\n";
  for (std::size_t n = 0; n < 5; ++n) {
    text += std::to_string(10 * (n + 1)) + " " + std::to_string(n) + " 0 1\n";
  }
  return text + "$EndNodeData\n";
}

inline std::string msh2_text() {
  return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"bone\"\n"
         "$EndPhysicalNames\n$Nodes\n5\n10 0 0 0\n20 1 0 0\n30 0 1 0\n40 0 0 1\n50 1 1 1\n"
         "$EndNodes\n$Elements\n4\n5 15 2 0 1 10\n6 2 2 0 1 20 30 40\n7 4 2 1 1 10 20 30 40\n"
         "8 4 2 1 1 20 30 40 50\n$EndElements\n" +
         gmsh_node_data();
}

inline std::string msh2_binary() {
  std::string nodes;
  for (std::int32_t n = 0; n < 5; ++n) {
    const auto* const xyz = &mesh_points[3 * static_cast<std::size_t>(n)];
    nodes += packed<std::int32_t>({10 * (n + 1)}) + packed<double>({xyz[0], xyz[1], xyz[2]});
  }
  return "$MeshFormat\n2.2 1 8\n" + packed<std::int32_t>({1}) + "\n$EndMeshFormat\n$Nodes\n5\n" +
         nodes + "\n$EndNodes\n$Elements\n3\n" +
         packed<std::int32_t>({2, 1, 2, 6, 0, 1, 20, 30, 40}) +
         packed<std::int32_t>({4, 2, 2, 7, 0, 1, 10, 20, 30, 40, 8, 0, 1, 20, 30, 40, 50}) +
         "\n$EndElements\n";
}

inline std::string msh4_text() {
  return "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"bone\"\n"
         "$EndPhysicalNames\n$Entities\n1 0 1 1\n1 0 0 0 0\n1 0 0 0 1 1 1 0 "
         "0\n1 0 0 0 1 1 1 1 1 0\n$EndEntities\n$Nodes\n1 5 10 50\n3 1 0 5\n10\n20\n30\n40\n50\n"
         "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n$EndNodes\n$Elements\n3 4 5 8\n"
         "0 1 15 1\n5 10\n2 1 2 1\n6 20 30 40\n3 1 4 2\n7 10 20 30 40\n8 20 30 40 50\n"
         "$EndElements\n" +
         gmsh_node_data();
}

inline std::string msh4_binary() {
  using Sizes = std::vector<std::uint64_t>;
  using Ints = std::vector<std::int32_t>;
  const std::string box = packed<double>({0, 0, 0, 1, 1, 1});
  return "$MeshFormat\n4.1 1 8\n" + packed(Ints{1}) + "\n$EndMeshFormat\n$Entities\n" +
         packed(Sizes{0, 0, 1, 1}) + packed(Ints{1}) + box + packed(Sizes{0, 0}) + packed(Ints{1}) +
         box + packed(Sizes{0, 0}) + "\n$EndEntities\n$Nodes\n" + packed(Sizes{1, 5, 10, 50}) +
         packed(Ints{3, 1, 0}) + packed(Sizes{5, 10, 20, 30, 40, 50}) + packed(mesh_points) +
         "\n$EndNodes\n$Elements\n" + packed(Sizes{2, 3, 6, 8}) + packed(Ints{2, 1, 2}) +
         packed(Sizes{1, 6, 20, 30, 40}) + packed(Ints{3, 1, 4}) +
         packed(Sizes{2, 7, 10, 20, 30, 40, 8, 20, 30, 40, 50}) + "\n$EndElements\n";
}

/// The file that the lists below name; it stays as it is.
inline const ForeignMesh listed_part = {"", "part.vtu", xml_mesh(false)};

inline std::string pvd_list() {
  return "<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n"
         "<DataSet timestep=\"0.5\" part=\"0\" file=\"part.vtu\"/>\n"
         "<DataSet timestep=\"2\" part=\"0\" file=\"part.vtu\"/>\n"
         "</Collection>\n</VTKFile>\n";
}

inline std::string series_list() {
  return "{\"file-series-version\": \"1.0\", \"files\": [\n{\"name\": \"part.vtu\", \"time\": "
         "0.5},\n{\"name\": \"part.vtu\", \"time\": 2}]}\n";
}

inline std::string vtm_list() {
  return "<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
         "<vtkMultiBlockDataSet>\n<DataSet index=\"0\" file=\"part.vtu\"/>\n"
         "<DataSet index=\"1\" file=\"part.vtu\"/>\n</vtkMultiBlockDataSet>\n</VTKFile>\n";
}

inline std::vector<ForeignMesh> foreign_meshes() {
  return {{"vtk", "a.vtk", legacy_text()},
          {"vtk-offsets", "b.vtk", legacy_text_with_offsets()},
          {"vtk-binary", "c.vtk", legacy_binary()},
          {"vtk-binary-offsets", "d.vtk", legacy_binary_with_offsets()},
          {"vtu", "e.vtu", xml_mesh(false)},
          {"vtu-appended", "f.vtu", xml_mesh(true)},
          {"msh2", "g.msh", msh2_text()},
          {"msh2-binary", "h.msh", msh2_binary()},
          {"msh4", "i.msh", msh4_text()},
          {"msh4-binary", "j.msh", msh4_binary()},
          {"pvd", "k.pvd", pvd_list()},
          {"series", "l.vtu.series", series_list()},
          {"vtm", "m.vtm", vtm_list()}};
}

}  // namespace tetwarp::test

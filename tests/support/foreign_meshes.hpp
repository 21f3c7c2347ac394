/// @file foreign_meshes.hpp
/// Meshes as text in the formats of VTK and Gmsh, for the tests of the command.
#pragma once
#include <string>
#include <vector>

#include <tetwarp/mesh.hpp>
#include <tetwarp/volume.hpp>

namespace tetwarp::test {

/// Numbers of a line, each after a space.
template <class Row>
std::string line_of(const Row& row, int added = 0) {
  std::string line;
  for (const auto number : row) line += " " + std::to_string(number + added);
  return line + "\n";
}

/// A mesh of tetrahedra as a legacy .vtk file; with a displacement of one step.
inline std::string legacy_vtk(const Mesh& mesh, const std::vector<Point3>& displacement = {}) {
  const std::size_t tets = mesh.tets.size();
  std::string text = "# vtk DataFile Version 3.0\nmesh\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " +
                     std::to_string(mesh.rest_positions.size()) + " double\n";
  for (const Point3& point : mesh.rest_positions) text += line_of(point);
  text += "CELLS " + std::to_string(tets) + " " + std::to_string(5 * tets) + "\n";
  for (const auto& tet : mesh.tets) text += "4" + line_of(tet);
  text += "CELL_TYPES " + std::to_string(tets) + "\n";
  for (std::size_t t = 0; t < tets; ++t) text += "10\n";
  if (displacement.empty()) return text;
  text += "POINT_DATA " + std::to_string(displacement.size()) + "\nVECTORS displacement double\n";
  for (const Point3& row : displacement) text += line_of(row);
  return text;
}

/// A mesh of tetrahedra as MSH 2; with a displacement of one step, the view `u`.
inline std::string msh(const Mesh& mesh, const std::vector<Point3>& displacement = {}) {
  std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" +
                     std::to_string(mesh.rest_positions.size()) + "\n";
  int node = 0;
  for (const Point3& point : mesh.rest_positions) text += std::to_string(++node) + line_of(point);
  text += "$EndNodes\n$Elements\n" + std::to_string(mesh.tets.size()) + "\n";
  int cell = 0;
  for (const auto& tet : mesh.tets) text += std::to_string(++cell) + " 4 2 1 1" + line_of(tet, 1);
  text += "$EndElements\n";
  if (displacement.empty()) return text;
  text += "$NodeData\n1\n\"u\"\n1\n0\n3\n0\n3\n" + std::to_string(displacement.size()) + "\n";
  node = 0;
  for (const Point3& row : displacement) text += std::to_string(++node) + line_of(row);
  return text + "$EndNodeData\n";
}

}  // namespace tetwarp::test

/// @file mesh_import.cpp
/// Choice of reader, cells and array for meshes of other programs.
#include "io/mesh_import.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>
#include <tetwarp/error.hpp>

namespace tetwarp {
namespace {
/// Between RAS and LPS.
void turn(std::vector<Point3>& vectors) {
  for (Point3& vector : vectors) vector = {0 - vector[0], 0 - vector[1], vector[2]};
}
}  // namespace

bool has_mesh_extension(const std::string& path) {
  return path.ends_with(".msh") || path.ends_with(".vtu") || path.ends_with(".vtk");
}

ImportedMesh import_mesh(const std::string& path, const MeshImportOptions& options) {
  if (!has_mesh_extension(path)) {
    throw IoError(path, "", "the name of a mesh to import must end in .msh, .vtu or .vtk");
  }
  if (!std::ifstream(path)) {
    throw IoError(path, "", std::string("cannot be opened: ") + std::strerror(errno));
  }
  ImportedMesh mesh =
      path.ends_with(".msh") ? read_gmsh_mesh(path, options) : read_vtk_mesh(path, options);
  if (mesh.mesh.cell_count() == 0) {
    throw IoError(path, "", "holds no tetrahedron or hexahedron: damaged, or a surface mesh");
  }
  if (mesh.mesh.rest_positions.size() > std::numeric_limits<std::int32_t>::max()) {
    throw IoError(path, "", "2^31 or more nodes; use a coarser mesh");
  }
  if (options.axes == Axes::lps) {
    turn(mesh.mesh.rest_positions);
    for (std::vector<Point3>& displacement : mesh.displacements) turn(displacement);
    for (MeshArray& array : mesh.arrays) turn_array(array);
  }
  return mesh;
}

void leave_out_cell(const std::string& path,
                    const CellKind& kind,
                    std::int64_t number,
                    ImportedMesh& into) {
  if (kind.dimension == 3) {
    throw IoError(path, "",
                  "cell " + std::to_string(number) + " is a " + kind.name +
                      ", expected tetrahedra of four nodes and hexahedra of eight; split the "
                      "cells");
  }
  ++into.skipped[kind.name];
}

std::optional<std::string> choose_displacement(const std::string& path,
                                               const std::vector<std::string>& names,
                                               const MeshImportOptions& options) {
  const std::string name = options.displacement.value_or("displacement");
  if (std::ranges::find(names, name) != names.end()) return name;
  if (!options.displacement) return std::nullopt;
  std::string listed;
  for (const std::string& name : names) listed += (listed.empty() ? "" : ", ") + name;
  throw IoError(path, name,
                "no such point array; the file has " + (listed.empty() ? "none" : listed));
}

}  // namespace tetwarp

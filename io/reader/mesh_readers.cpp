/// @file mesh_readers.cpp
/// Choice of the library by the name of the file, and of the cells and the array that are kept.
#include "io/reader/mesh_readers.hpp"

#include <algorithm>
#include <tetwarp/error.hpp>

#include "io/files/extension.hpp"

namespace tetwarp {

ImportedMesh read_foreign_mesh(const std::string& path, const MeshImportOptions& options) {
  if (has_extension(path, ".msh")) return read_gmsh_mesh(path, options);
  return options.needs_solids ? read_vtk_mesh(path, options) : read_vtk_surface(path, options);
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

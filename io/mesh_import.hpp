/// @file mesh_import.hpp
/// What the readers of foreign meshes share.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/mesh_import.hpp>

namespace tetwarp {

/// One per library; where it is missing, a function that says so.
ImportedMesh read_gmsh_mesh(const std::string& path, const MeshImportOptions& options);
ImportedMesh read_vtk_mesh(const std::string& path, const MeshImportOptions& options);

/// A kind of cell, as a format calls it.
struct CellKind {
  std::string name;
  int dimension;
  bool is_tetrahedron;
};

/// True for cells to keep. Others are counted when they have fewer dimensions.
/// @param number  of the cell in its file
/// @throws IoError on other cells of three dimensions
bool keeps_cell(const std::string& path,
                const CellKind& kind,
                std::int64_t number,
                ImportedMesh& into);

/// The array of displacements among those of a file; nothing: the file has none.
/// @throws IoError when one was asked for that is not there
std::optional<std::string> choose_displacement(const std::string& path,
                                               const std::vector<std::string>& names,
                                               const MeshImportOptions& options);

}  // namespace tetwarp

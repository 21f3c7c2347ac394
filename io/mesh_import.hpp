/// @file mesh_import.hpp
/// What the readers of foreign meshes share.
#pragma once
#include <array>
#include <cstddef>
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
  int kept_nodes;  ///< 4 of a tetrahedron, 8 of a hexahedron, 0 of others
};

/// Counts a cell that is not kept. @throws IoError when it has three dimensions
void leave_out_cell(const std::string& path,
                    const CellKind& kind,
                    std::int64_t number,
                    ImportedMesh& into);

/// Adds a cell that is kept, counts one of fewer dimensions.
/// @param number   of the cell in its file
/// @param node_at  its nodes by their places in the mesh, in VTK's order: node_at(0) and so on
/// @throws IoError on other cells of three dimensions
template <class NodeAt>
void add_cell(const std::string& path,
              const CellKind& kind,
              std::int64_t number,
              const NodeAt& node_at,
              ImportedMesh& into) {
  const auto nodes = [&]<std::size_t count>(std::array<std::int32_t, count> cell) {
    for (std::size_t n = 0; n < count; ++n) cell[n] = static_cast<std::int32_t>(node_at(n));
    return cell;
  };
  if (kind.kept_nodes == 4) {
    into.mesh.tets.push_back(nodes(std::array<std::int32_t, 4>{}));
  } else if (kind.kept_nodes == 8) {
    into.mesh.hexes.push_back(nodes(std::array<std::int32_t, 8>{}));
  } else {
    leave_out_cell(path, kind, number, into);
  }
}

/// The array of displacements among those of a file; nothing: the file has none.
/// @throws IoError when one was asked for that is not there
std::optional<std::string> choose_displacement(const std::string& path,
                                               const std::vector<std::string>& names,
                                               const MeshImportOptions& options);

}  // namespace tetwarp

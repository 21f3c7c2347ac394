/// @file mesh_import.hpp
/// Meshes as other programs write them: Gmsh's MSH 2 and 4.1 (.msh), VTK's XML and legacy
/// unstructured grids (.vtu, .vtk). Gmsh and VTK read them; a build may lack either.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <tetwarp/io_export.hpp>
#include <tetwarp/mesh.hpp>

namespace tetwarp {

/// Choices of import_mesh().
struct MeshImportOptions {
  /// Point array (Gmsh: view of node data) of three components that moves the nodes; nothing:
  /// `displacement`, where the file has it.
  std::optional<std::string> displacement = {};
};

/// What a file holds. write_mesh() takes it as it is.
struct ImportedMesh {
  Mesh mesh;  ///< every node of the file, in its order, at rest
  std::vector<std::vector<Point3>> displacements;  ///< one per step; empty: none
  std::vector<double> times;                       ///< one per step
  /// Cells of fewer dimensions, which move nothing, counted by what the format calls them.
  std::map<std::string, std::int64_t> skipped;
};

/// True for names that end in .msh, .vtu or .vtk.
TETWARP_IO_EXPORT bool has_mesh_extension(const std::string& path);

/// Reads a mesh of tetrahedra and hexahedra with its displacement, step by step where the file has
/// several. Files are told apart by the end of their name.
///
/// Throws IoError on other cells of three dimensions, naming kind and number; on files that are
/// damaged; and, naming the package, where this build lacks the library.
TETWARP_IO_EXPORT ImportedMesh import_mesh(const std::string& path,
                                           const MeshImportOptions& options = {});

}  // namespace tetwarp

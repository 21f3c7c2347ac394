/// @file mesh_readers.hpp
/// The readers of meshes of other programs, and what they share.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/mesh_import.hpp>

#include "io/volume/mesh_arrays.hpp"

namespace tetwarp {

/// One reader per library; in a build without the library it throws MissingLibrary.
ImportedMesh read_gmsh_mesh(const std::string& path, const MeshImportOptions& options);
ImportedMesh read_vtk_mesh(const std::string& path, const MeshImportOptions& options);

/// Reads triangles by VTK: of surfaces, or of an unstructured grid. Other cells of two dimensions
/// are divided into triangles.
ImportedMesh read_vtk_surface(const std::string& path, const MeshImportOptions& options);

/// All points of a file that VTK reads, in its order. Of .stl every triangle has points of its own.
std::vector<Point3> read_vtk_points(const std::string& path);

/// Writes a copy of such a file with other points and a point array `inside`, see
/// place_points_in_child(). Cells and all arrays are kept where the format of the output has them.
void place_vtk_points(const std::string& path,
                      const std::string& numbers,
                      const std::string& output);

/// Triangles, as the members of Surface.
struct CoarseMesh {
  std::vector<Point3> points;
  std::vector<std::array<std::int32_t, 3>> triangles;
};

/// Decimates by VTK, see coarse_surface().
/// @param path  a file of the numbers of points and triangles as uint64, x y z as float64 for every
///              point, and three int32 for every triangle
CoarseMesh coarsen_by_vtk(const std::string& path, double distance);

/// Reads a mesh by the library of its format. Most checks are left to import_mesh().
ImportedMesh read_foreign_mesh(const std::string& path, const MeshImportOptions& options);

/// The cells that are kept. Nodes are in VTK's order.
enum class CellShape {
  other,     ///< not kept
  triangle,  ///< kept beside the mesh
  tetrahedron,
  curved_tetrahedron,  ///< of ten nodes
  hexahedron,
  voxel,   ///< a hexahedron in another order
  wedge,   ///< becomes a hexahedron with two edges of no length, which has the same map
  pyramid  ///< becomes a hexahedron whose upper nodes are one
};

/// Nodes of a kept cell in its file; 0 of others.
std::size_t node_count(CellShape shape);

/// A kind of cell.
struct CellKind {
  std::string name;  ///< in the format's words
  int dimension;
  CellShape shape;
};

/// Counts a cell that is not kept. @throws IoError when it has three dimensions
void leave_out_cell(const std::string& path,
                    const CellKind& kind,
                    std::int64_t number,
                    ImportedMesh& into);

/// Most nodes of a kept cell.
constexpr std::size_t most_cell_nodes = 10;

/// Adds a kept cell. @param nodes  node_count() of them
void add_kept_cell(CellShape shape,
                   const std::int32_t* nodes,
                   std::int64_t number,
                   ImportedMesh& into,
                   CellNumbers& numbers);

/// Adds a cell that is kept and its number, counts one of fewer dimensions. Triangles are both.
/// @param number   of the cell in its file
/// @param node_at  function from 0, 1 ... in VTK's order of nodes to an index in the mesh
/// @throws IoError on other cells of three dimensions
template <class NodeAt>
void add_cell(const std::string& path,
              const CellKind& kind,
              std::int64_t number,
              const NodeAt& node_at,
              ImportedMesh& into,
              CellNumbers& numbers) {
  std::array<std::int32_t, most_cell_nodes> nodes;
  for (std::size_t n = 0; n < node_count(kind.shape); ++n) {
    nodes[n] = static_cast<std::int32_t>(node_at(n));
  }
  add_kept_cell(kind.shape, nodes.data(), number, into, numbers);
  if (kind.shape == CellShape::other || kind.shape == CellShape::triangle) {
    leave_out_cell(path, kind, number, into);
  }
}

/// The name of the array of displacements in a file; nothing: the file has none.
/// @throws IoError when the file lacks the requested one
std::optional<std::string> choose_displacement(const std::string& path,
                                               const std::vector<std::string>& names,
                                               const MeshImportOptions& options);

}  // namespace tetwarp

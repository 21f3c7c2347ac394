/// @file mesh_import.hpp
/// Meshes of other programs: Gmsh's MSH 2 and 4.1 (.msh), VTK's XML and legacy unstructured grids
/// (.vtu, .vtk), blocks (.vtm) and series of these (.pvd, .series, numbered files), Exodus. The
/// libraries of Gmsh and VTK read them; a build may be without either.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <tetwarp/axes.hpp>
#include <tetwarp/curved_mesh.hpp>
#include <tetwarp/io_export.hpp>
#include <tetwarp/mesh.hpp>
#include <tetwarp/mesh_array.hpp>

namespace tetwarp {

/// Choices of import_mesh().
struct MeshImportOptions {
  /// Point array (Gmsh: view of node data) of three components, added to the rest positions
  /// [world]. Without a value: `displacement`, where the file has it.
  std::optional<std::string> displacement = {};
  /// Axes of nodes, displacements and other vectors in the file; LPS is turned to RAS.
  Axes axes = Axes::ras;
  /// Time that reading may take [s]. 0: 120 s and 5 s per megabyte of the file.
  double time_limit = 0;
  /// Whether the file must have tetrahedra or hexahedra; else it must have triangles, and formats
  /// of surfaces are read, too. Of these, points at the same place are joined where the surface is
  /// open.
  bool needs_solids = true;
  /// Whether tetrahedra of ten nodes stay what they are; else they become eight straight ones.
  bool keeps_curved = false;
};

/// The content of a file, in the form that write_mesh() takes.
struct ImportedMesh {
  Mesh mesh;  ///< every node of the file at rest, in its order (of Gmsh: by tag)
  std::vector<std::vector<Point3>> displacements;  ///< per step, per node [world]; empty: none
  std::vector<double> times;                       ///< one per step
  /// Number of cells of fewer than three dimensions, which are not in `mesh`, by their kind.
  std::map<std::string, std::int64_t> skipped;
  /// Other arrays of nodes and cells, of the first step. `original_cell` holds the number of each
  /// cell in the file: in VTK's from 0, in Gmsh's its tag; of Gmsh `original_node` holds the tags
  /// of nodes, `group` the physical group of each cell (0: none) and the names of groups.
  std::vector<MeshArray> arrays = {};
  std::vector<std::string> left_out = {};  ///< other content of the file, by kind and name
  std::string merged = {};  ///< how many cells are there twice, as a text; empty: none
  std::vector<std::array<std::int32_t, 3>> triangles = {};  ///< indices into rest_positions
  /// Whether the displacements are those of points that move with the steps, no array of the file.
  bool moves_points = false;
  /// With MeshImportOptions::keeps_curved those of CurvedMesh; empty: no cell has ten nodes.
  std::vector<MidNodes> mid_nodes = {};
};

/// True for names that end in .msh, .vtu, .vtk, .vtm, .pvd, .series, .e, .exo or .ex2, also in
/// capital letters.
TETWARP_IO_EXPORT bool has_mesh_extension(const std::string& path);

/// True for names of surfaces alone: .stl, .ply, .obj or .vtp, also in capital letters.
TETWARP_IO_EXPORT bool has_surface_extension(const std::string& path);

/// Reads a mesh of tetrahedra and hexahedra with all steps of its displacement. The format is
/// chosen by the end of the name. A '*' in the name stands for any letters: the files are the steps
/// of one mesh, in order of the numbers in their names.
///
/// A tetrahedron of ten nodes becomes eight straight ones between them, see split_curved(), unless
/// it is kept. A wedge becomes a hexahedron with repeated nodes, and so does a pyramid: their maps
/// are the same.
///
/// VTK and Gmsh crash on some damaged files. They are in a program of their own, tetwarp-read,
/// which sends the mesh back: a crash, an endless loop or an explosion of memory ends that program
/// and becomes an IoError. Its memory is limited to 4 GiB and 1000 bytes per byte of the file, and
/// to what the machine has left. Indices, counts and numbers are checked again in the caller.
///
/// The environment variable TETWARP_READER is the path of that program. Without it, it is searched
/// beside the library (the static one: beside the program), in libexec/tetwarp of the folder where
/// both are installed, and where the library was configured to be installed. It ends with the
/// thread that calls. Where the caller ignores SIGCHLD, an error does not name the signal of a
/// crash.
/// @throws IoError on other cells of three dimensions, on damaged files, if tetwarp-read is not
///         found, and if it was built without the library; the text names kind and number of the
///         cells, the places searched, or the package
/// @throws std::runtime_error when tetwarp-read cannot be started or lacks a library
TETWARP_IO_EXPORT ImportedMesh import_mesh(const std::string& path,
                                           const MeshImportOptions& options = {});

}  // namespace tetwarp

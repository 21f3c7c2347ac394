/// @file vtkhdf_mesh_file.hpp
/// A VTKHDF UnstructuredGrid: the rows of the parts of each step, read into one mesh.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <tetwarp/curved_mesh.hpp>
#include <tetwarp/volume.hpp>

#include "io/h5/h5.hpp"
#include "io/vtkhdf/vtkhdf_input.hpp"

namespace tetwarp {

/// Values of the dataset Types.
constexpr std::uint8_t vtk_triangle = 5;
constexpr std::uint8_t vtk_tetra = 10;
constexpr std::uint8_t vtk_hexahedron = 12;
constexpr std::uint8_t vtk_quadratic_tetra = 24;

/// The rows of one part of one step: first row and number in each dataset.
struct MeshPart {
  std::int64_t node_count = 0;
  std::int64_t cell_count = 0;
  std::int64_t id_count = 0;      ///< entries of Connectivity
  std::int64_t first_node = 0;    ///< row of Points
  std::int64_t first_cell = 0;    ///< row of Types
  std::int64_t first_offset = 0;  ///< row of Offsets, which has one row more than cells per part
  std::int64_t first_id = 0;      ///< row of Connectivity

  bool operator==(const MeshPart&) const = default;
};

/// Kinds of cells that a mesh may have.
enum class CellChoice {
  solids,    ///< tetrahedra and hexahedra
  triangles  ///< triangles
};

/// Cells of a step by kind. Node indices continue from part to part.
struct MeshCells {
  std::vector<std::array<std::int32_t, 4>> tets;
  std::vector<std::array<std::int32_t, 8>> hexes;
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<MidNodes> mid_nodes;  ///< of tets, as of CurvedMesh; empty: none has ten nodes
  /// Number of cells of fewer than three dimensions beside solids, of all others beside triangles,
  /// by their kind.
  std::map<std::string, std::int64_t> skipped;

  std::size_t count() const { return tets.size() + hexes.size() + triangles.size(); }
};

/// An open mesh file. Every row is checked against the datasets before anything is allocated.
class MeshFile {
 public:
  explicit MeshFile(const std::string& path);

  const VtkhdfInput& file() const { return file_; }
  bool has_displacement() const { return static_cast<bool>(displacement_.handle); }

  /// Parts of a step, in the file's order; static files have step 0.
  std::vector<MeshPart> parts_of(std::int64_t step) const;

  /// Names of the values of the cell array `group`; empty where the file has none.
  std::map<std::int64_t, std::string> group_names() const;

  std::vector<Point3> read_points(std::int64_t step) const;
  /// Numbers may not be finite.
  std::vector<Point3> read_displacement(std::int64_t step) const;
  /// Throws IoError unless all are finite.
  void check_displacement(const std::vector<Point3>& displacement) const;

  /// What is not read, as paths below /VTKHDF: arrays but the displacement, field data.
  std::vector<std::string> not_read() const;

  /// Whether a step has a cell of three dimensions, also of a kind that is not read.
  bool has_solids(std::int64_t step) const;

  /// Cells of all parts. @throws IoError  when there is none of the choice; of solids also on cells
  /// of
  ///                              three dimensions of another kind
  MeshCells read_cells(std::int64_t step, CellChoice choice = CellChoice::solids) const;

 private:
  void check_displacement_offsets() const;
  /// Steps/<name> of a step; 0 in static files and where the file has no such dataset.
  std::int64_t offset_of(const std::vector<std::int64_t>& offsets, std::int64_t step) const;
  std::vector<Point3> read_rows(const h5::Dataset& dataset,
                                const std::vector<MeshPart>& parts,
                                std::int64_t shift) const;
  /// The type of each cell of a part, 0 of those that are skipped.
  std::vector<std::int64_t> read_cell_types(const MeshPart& part,
                                            std::int64_t first_cell,
                                            CellChoice choice,
                                            MeshCells& cells) const;
  void read_part_cells(const MeshPart& part,
                       std::int64_t first_node,
                       std::int64_t first_cell,
                       CellChoice choice,
                       MeshCells& cells) const;

  VtkhdfInput file_;
  h5::Dataset points_;
  h5::Dataset types_;
  h5::Dataset offsets_;
  h5::Dataset connectivity_;
  h5::Dataset displacement_;
  std::vector<std::int64_t> node_counts_;  // one entry per part
  std::vector<std::int64_t> cell_counts_;
  std::vector<std::int64_t> id_counts_;
  std::vector<std::int64_t> part_counts_;  // one entry per step, empty where absent
  std::vector<std::int64_t> part_offsets_;
  std::vector<std::int64_t> point_offsets_;
  std::vector<std::int64_t> cell_offsets_;
  std::vector<std::int64_t> id_offsets_;
  std::vector<std::int64_t> displacement_offsets_;
};

}  // namespace tetwarp

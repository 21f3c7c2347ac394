/// @file mesh_arrays.hpp
/// Arrays and numbers that imported meshes keep.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/mesh_import.hpp>

namespace tetwarp {

/// Numbers of the kept cells in their file.
struct CellNumbers {
  std::vector<std::int64_t> tets;
  std::vector<std::int64_t> hexes;

  /// In the order of a mesh: tetrahedra first.
  std::vector<std::int64_t> all() const;
};

/// Adds an array of one number per row.
void add_numbers(const std::string& name,
                 bool is_of_cells,
                 const std::vector<std::int64_t>& numbers,
                 ImportedMesh& into);

/// "group", "group_2", "group_3" ... for 0, 1, 2 ...: the arrays of the first, second ... group of
/// each cell.
std::string group_name(std::size_t index);

/// True unless a VTKHDF file cannot hold the name, or import writes another array of that name.
bool is_free_name(const std::string& name);

/// Which nodes cells and triangles have. @pre  their indices are checked
std::vector<bool> nodes_of_cells(const Mesh& mesh,
                                 const std::vector<std::array<std::int32_t, 3>>& triangles = {},
                                 const std::vector<MidNodes>& mid_nodes = {});

/// Makes displacements that are not finite 0 at nodes of no cell, where they move nothing.
void clear_unused(const std::vector<bool>& used, std::vector<Point3>& displacement);

}  // namespace tetwarp

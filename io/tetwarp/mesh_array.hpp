/// @file mesh_array.hpp
/// Arrays of mesh files beside the displacement.
#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <tetwarp/choices.hpp>

namespace tetwarp {

/// Numbers of every node or of every cell of a mesh.
struct MeshArray {
  std::string name;          ///< without '/' and '.'
  bool is_of_cells = false;  ///< a row per cell, tetrahedra first; false: a row per node
  PixelType type = PixelType::float64;
  int components = 1;
  std::vector<std::byte> data;  ///< [row][component]
  /// Names of values, of integer arrays of one component: of `group` those of physical groups.
  std::map<std::int64_t, std::string> value_names = {};
};

}  // namespace tetwarp

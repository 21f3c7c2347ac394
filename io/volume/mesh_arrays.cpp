/// @file mesh_arrays.cpp
/// Numbers of cells as arrays, names that are free, and nodes that cells have.
#include "io/volume/mesh_arrays.hpp"

#include <span>
#include <utility>

#include "host/base/point3.hpp"

namespace tetwarp {

std::vector<std::int64_t> CellNumbers::all() const {
  std::vector<std::int64_t> numbers = tets;
  numbers.insert(numbers.end(), hexes.begin(), hexes.end());
  return numbers;
}

void add_numbers(const std::string& name,
                 bool is_of_cells,
                 const std::vector<std::int64_t>& numbers,
                 ImportedMesh& into) {
  const auto bytes = std::as_bytes(std::span(numbers));
  MeshArray array{name, is_of_cells, PixelType::int64, 1, {bytes.begin(), bytes.end()}};
  into.arrays.push_back(std::move(array));
}

std::string group_name(std::size_t index) {
  return index == 0 ? "group" : "group_" + std::to_string(index + 1);
}

bool is_free_name(const std::string& name) {
  return !name.empty() && name.find_first_of("/.") == std::string::npos && name != "displacement" &&
         name != "original_cell" && name != "original_node";
}

std::vector<bool> nodes_of_cells(const Mesh& mesh,
                                 const std::vector<std::array<std::int32_t, 3>>& triangles,
                                 const std::vector<MidNodes>& mid_nodes) {
  std::vector<bool> used(mesh.rest_positions.size());
  const auto mark = [&](const auto& cells) {
    for (const auto& cell : cells) {
      for (const std::int32_t node : cell) {
        if (node >= 0) used[static_cast<std::size_t>(node)] = true;  // -1: no middle nodes
      }
    }
  };
  mark(mesh.tets);
  mark(mesh.hexes);
  mark(triangles);
  mark(mid_nodes);
  return used;
}

void clear_unused(const std::vector<bool>& used, std::vector<Point3>& displacement) {
  for (std::size_t node = 0; node < displacement.size(); ++node) {
    if (!used[node] && !is_finite(displacement[node])) displacement[node] = {0, 0, 0};
  }
}

}  // namespace tetwarp

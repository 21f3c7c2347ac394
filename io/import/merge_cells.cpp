/// @file merge_cells.cpp
/// Finds repeated cells, joins their groups, and drops their rows.
#include "io/import/merge_cells.hpp"

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>

#include "host/base/repeated_cells.hpp"
#include "io/volume/mesh_arrays.hpp"

namespace tetwarp {
namespace {

MeshArray* find_group(ImportedMesh& mesh, std::size_t index) {
  const auto found = std::ranges::find_if(mesh.arrays, [&](const MeshArray& array) {
    return array.is_of_cells && array.name == group_name(index) && array.type == PixelType::int64 &&
           array.components == 1;
  });
  return found == mesh.arrays.end() ? nullptr : &*found;
}

std::int64_t value_at(const MeshArray& array, std::size_t row) {
  std::int64_t value = 0;
  std::memcpy(&value, array.data.data() + row * sizeof value, sizeof value);
  return value;
}

/// Gives each first cell the groups of its copies, too.
void join_groups(const std::vector<std::size_t>& firsts, ImportedMesh& mesh) {
  std::vector<std::vector<std::int64_t>> groups(firsts.size());
  std::size_t most = 0;
  for (std::size_t index = 0; const MeshArray* array = find_group(mesh, index); ++index) {
    for (std::size_t row = 0; row < firsts.size(); ++row) {
      const std::int64_t group = value_at(*array, row);
      std::vector<std::int64_t>& of = groups[firsts[row]];
      if (group != 0 && std::ranges::find(of, group) == of.end()) of.push_back(group);
      most = std::max(most, of.size());
    }
  }
  for (std::size_t index = 0; index < most; ++index) {
    std::vector<std::int64_t> rows;
    for (const auto& of : groups) rows.push_back(index < of.size() ? of[index] : 0);
    MeshArray* array = find_group(mesh, index);
    if (array == nullptr) {
      auto names = find_group(mesh, 0)->value_names;
      add_numbers(group_name(index), true, rows, mesh);
      mesh.arrays.back().value_names = std::move(names);
    } else {
      std::memcpy(array->data.data(), rows.data(), array->data.size());
    }
  }
}

}  // namespace

void merge_cells(ImportedMesh& mesh) {
  const std::vector<Point3>& nodes = mesh.mesh.rest_positions;
  const std::size_t tets = mesh.mesh.tets.size();
  std::vector<std::size_t> firsts = first_tet_copies(nodes, mesh.mesh.tets, mesh.mid_nodes);
  const auto hex_firsts = first_copies(nodes, mesh.mesh.hexes, SameCells::places);
  const std::vector<std::size_t> tet_firsts = firsts;
  for (const std::size_t hex : hex_firsts) firsts.push_back(tets + hex);
  const std::size_t copies = copy_count(firsts);
  if (copies == 0) return;
  mesh.merged = merged_text(copies, firsts.size(), "cells");
  join_groups(firsts, mesh);
  for (MeshArray& array : mesh.arrays) {
    if (!array.is_of_cells) continue;
    const std::size_t row_size = array.data.size() / firsts.size();
    std::size_t kept = 0;
    for (std::size_t row = 0; row < firsts.size(); ++row) {
      if (firsts[row] != row) continue;
      std::memmove(array.data.data() + kept++ * row_size, array.data.data() + row * row_size,
                   row_size);
    }
    array.data.resize(kept * row_size);
  }
  keep_firsts(tet_firsts, mesh.mesh.tets);
  keep_firsts(tet_firsts, mesh.mid_nodes);
  keep_firsts(hex_firsts, mesh.mesh.hexes);
}

}  // namespace tetwarp

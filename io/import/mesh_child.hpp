/// @file mesh_child.hpp
/// Meshes that are read in a child process.
#pragma once
#include <functional>
#include <string>
#include <type_traits>

#include "io/import/child_process.hpp"
#include "io/import/mesh_import.hpp"

namespace tetwarp {

/// Runs `read` in a child process and returns its mesh, which is not checked.
/// @throws IoError of `read`; or about `path` when the child crashes or exceeds its limits
ImportedMesh read_mesh_in_child(const std::string& path,
                                const ChildLimits& limits,
                                const std::function<ImportedMesh()>& read);

/// Sends or reads all members of an array.
/// @param message  a MessageWriter or a MessageReader
/// @param value    const for a MessageWriter
template <class Message, class Value>
requires std::is_same_v<std::remove_const_t<Value>, MeshArray>
void exchange_members(Message& message, Value& value) {
  auto& [name, is_of_cells, type, components, data, value_names] = value;
  message(name);
  message(is_of_cells);
  message(type);
  message(components);
  message(data);
  message(value_names);
}

/// Sends or reads all members of a mesh.
/// @param message  a MessageWriter or a MessageReader
template <class Message>
void exchange_members(Message& message, ImportedMesh& value) {
  // All members: a new one does not compile.
  auto& [mesh, displacements, times, skipped, arrays, left_out, merged, triangles] = value;
  auto& [rest_positions, tets, hexes] = mesh;
  message(rest_positions);
  message(tets);
  message(hexes);
  message(displacements);
  message(times);
  message(skipped);
  message(arrays);
  message(left_out);
  message(merged);
  message(triangles);
}

}  // namespace tetwarp

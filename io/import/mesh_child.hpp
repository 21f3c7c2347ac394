/// @file mesh_child.hpp
/// Meshes that the program tetwarp-read reads, and the members of a mesh in its message.
#pragma once
#include <cstdint>
#include <string>
#include <type_traits>

#include <tetwarp/mesh_import.hpp>

namespace tetwarp {

struct ChildLimits {
  double seconds;  ///< from the start to the last byte of the result
  double memory;   ///< [byte] that the program may allocate
};

/// First value of a message: a mesh follows, or name of a dataset and text of an error.
enum class ChildOutcome : std::uint8_t { mesh, error };

/// Has the program read a mesh, which is not checked. TETWARP_READER in the environment is its
/// path; else it is searched beside this library or program and where both are installed.
/// @throws IoError of the reader; when the program is not found, crashes or exceeds its limits
/// @throws std::runtime_error when it cannot be started or lacks a library
ImportedMesh read_mesh_in_child(const std::string& path,
                                const MeshImportOptions& options,
                                const ChildLimits& limits);

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

/// @file mesh_child.hpp
/// Meshes that the program tetwarp-read reads, and the members of a mesh in its message.
#pragma once
#include <string>
#include <type_traits>
#include <vector>

#include <tetwarp/mesh_import.hpp>

#include "io/child/reader_program.hpp"

namespace tetwarp {

/// Has the program read a mesh, which is not checked. Errors as of run_reader().
ImportedMesh read_mesh_in_child(const std::string& path,
                                const MeshImportOptions& options,
                                const ChildLimits& limits);

/// Has the program read the points of a file; errors as above.
std::vector<Point3> read_points_in_child(const std::string& path);

/// Has the program write a file with other points and an array `inside`; errors as above.
/// @param numbers  a file of x y z as float64 for every point, then a byte for every point
/// @param output   of the format of its suffix
void place_points_in_child(const std::string& path,
                           const std::string& numbers,
                           const std::string& output);

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
  auto& [mesh, displacements, times, skipped, arrays, left_out, merged, triangles, moves_points,
         mid_nodes] = value;
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
  message(moves_points);
  message(mid_nodes);
}

}  // namespace tetwarp

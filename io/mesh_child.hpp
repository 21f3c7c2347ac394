/// @file mesh_child.hpp
/// Meshes that are read in a child process.
#pragma once
#include <functional>
#include <string>

#include "io/child_process.hpp"
#include "io/mesh_import.hpp"

namespace tetwarp {

/// Runs `read` in a child process and returns its mesh, which is not checked.
/// @throws IoError of `read`; or about `path` when the child crashes or exceeds its limits
ImportedMesh read_mesh_in_child(const std::string& path,
                                const ChildLimits& limits,
                                const std::function<ImportedMesh()>& read);

/// Sends or reads all members of a mesh.
/// @param message  a MessageWriter or a MessageReader
template <class Message>
void exchange(Message& message, ImportedMesh& value) {
  auto& [mesh, displacements, times, skipped] = value;  // all: a new member does not compile
  auto& [rest_positions, tets, hexes] = mesh;
  message(rest_positions);
  message(tets);
  message(hexes);
  message(displacements);
  message(times);
  message(skipped);
}

}  // namespace tetwarp

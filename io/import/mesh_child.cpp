/// @file mesh_child.cpp
/// Has tetwarp-read answer, and reads meshes and points from its message.
#include "io/import/mesh_child.hpp"

#include <utility>
#include <vector>

namespace tetwarp {

ImportedMesh read_mesh_in_child(const std::string& path,
                                const MeshImportOptions& options,
                                const ChildLimits& limits) {
  std::vector<std::string> words = {options.needs_solids ? "solids" : "triangles"};
  if (options.displacement) words.push_back(*options.displacement);
  ImportedMesh mesh;
  run_reader(path, std::move(words), limits,
             [&](auto& message) { exchange_members(message, mesh); });
  return mesh;
}

std::vector<Point3> read_points_in_child(const std::string& path) {
  std::vector<Point3> points;
  run_reader(path, {"points"}, limits_for(path), [&](auto& message) { message(points); });
  return points;
}

void place_points_in_child(const std::string& path,
                           const std::string& numbers,
                           const std::string& output) {
  run_reader(path, {"place", numbers, output}, limits_for(path), [](auto&) {});
}

}  // namespace tetwarp

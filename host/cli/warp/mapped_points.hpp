/// @file mapped_points.hpp
/// Points that a mesh of a file moves.
#pragma once
#include <utility>
#include <vector>

#include <tetwarp/io.hpp>
#include <tetwarp/map_points.hpp>

namespace tetwarp::cli {

/// map_points() by the straight or curved cells that the reader keeps.
/// @param deformed  positions of the nodes, those of a step
inline MappedPoints mapped_by(const MeshReader& mesh,
                              const std::vector<Point3>& deformed,
                              std::vector<Point3> points,
                              const MapPointsOptions& options) {
  if (mesh.mid_nodes().empty()) {
    return map_points(mesh.mesh(), deformed, std::move(points), options);
  }
  return map_points(CurvedMesh{mesh.mesh(), mesh.mid_nodes()}, deformed, std::move(points),
                    options);
}

}  // namespace tetwarp::cli

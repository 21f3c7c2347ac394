/// @file mapped_points.hpp
/// Points that a mesh of a file moves.
#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include <tetwarp/io.hpp>
#include <tetwarp/map_points.hpp>

namespace tetwarp::cli {

/// map_points() by the straight or curved cells that the reader keeps.
/// @param step  whose positions are the deformed ones
inline MappedPoints mapped_by(const MeshReader& mesh,
                              std::int64_t step,
                              std::vector<Point3> points,
                              const MapPointsOptions& options) {
  if (mesh.mid_nodes().empty()) {
    return map_points(mesh.mesh(), mesh.read_step(step), std::move(points), options);
  }
  return map_points(CurvedMesh{mesh.mesh(), mesh.mid_nodes()}, mesh.read_step(step),
                    std::move(points), options);
}

}  // namespace tetwarp::cli

/// @file point_backend.hpp
/// The interface between map_points() and the back ends. Arguments have been checked before.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/curved_mesh.hpp>
#include <tetwarp/map_points.hpp>

namespace tetwarp {

/// Checked arguments of map_points().
struct PointPlan {
  const Mesh& mesh;  ///< its last tetrahedra are those that the hexahedra were split into
  const std::vector<MidNodes>& mid_nodes;  ///< of its first tetrahedra; may be empty
  const std::vector<Point3>& from;         ///< nodes where the points are [world]
  const std::vector<Point3>& to;           ///< nodes where they are taken [world]
  Grid grid;                               ///< its index space is the one of the rounded positions
  int device;
  int threads;
};

/// Each moves the points in `result`, sets their owners, of which there are as many, and counts
/// MappedPoints::straightened.
void move_points_cpu(const PointPlan& plan, MappedPoints& result);
void move_points_cuda(const PointPlan& plan, MappedPoints& result);
void move_points_reference(const PointPlan& plan, MappedPoints& result);

}  // namespace tetwarp

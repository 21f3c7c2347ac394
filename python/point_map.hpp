/// @file point_map.hpp
/// Points that a deformation of tetrahedra takes along.
#pragma once
#include <array>
#include <cstdint>
#include <tetwarp/volume.hpp>
#include <vector>

namespace tetwarp::python {

struct MappedPoints {
  std::vector<Point3> points;        ///< not a number where no tetrahedron holds the point
  std::vector<std::int32_t> owners;  ///< tetrahedron, -1: none
};

/// Moves points with the tetrahedra that hold them: the owner of a point is the tetrahedron of the
/// lowest number whose closed shape contains it, as of a voxel in a warp. Owners are decided in
/// exact integers, after nodes and points are rounded to 2^-20 voxel of `grid`; in the grid of a
/// warp, centers of voxels have the owners of the warp.
/// @param from, to  nodes of the tetrahedra, where the points are and where they are taken [world]
/// @throws std::invalid_argument  nodes that are not finite or too far from the grid, tetrahedra of
///         more than 2^20 of its voxels
MappedPoints map_points(const std::vector<Point3>& points,
                        const Grid& grid,
                        const std::vector<Point3>& from,
                        const std::vector<std::array<std::int32_t, 4>>& tets,
                        const std::vector<Point3>& to);

}  // namespace tetwarp::python

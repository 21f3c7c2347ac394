/// @file map_points.hpp
/// Points that a deformed mesh takes along, and back: landmarks, contours, surfaces.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include <tetwarp/backend.hpp>
#include <tetwarp/curved_mesh.hpp>
#include <tetwarp/export.hpp>
#include <tetwarp/mesh.hpp>
#include <tetwarp/volume.hpp>

namespace tetwarp {

/// Choices of map_points().
struct MapPointsOptions {
  bool inverse = false;  ///< from the deformed to the rest positions
  /// Its voxels set the rounding: owners are those of a warp onto this grid. Nothing: a grid whose
  /// quantum is at most 2^-36 of the longest side of the mesh.
  std::optional<Grid> grid = {};
  Backend backend = Backend::automatic;  ///< automatic: cpu
  int device = 0;                        ///< CUDA device number
  int threads = 0;                       ///< of the cpu back end; 0: all cores
};

/// Result of map_points(), in the order of the points.
struct MappedPoints {
  std::vector<Point3> points;        ///< those that no cell holds are where they were
  std::vector<std::int32_t> owners;  ///< number of the mesh's cell, -1: none
  std::int64_t outside = 0;          ///< number of points that no cell holds
  /// Number of points in tetrahedra of ten nodes that move with the straight one, see CurvedMesh.
  std::int64_t straightened = 0;
};

/// Moves points with the cells that hold them. The owner of a point is that of a voxel in a warp:
/// the tetrahedron of the lowest number whose closed shape contains it, decided in exact integers
/// after nodes and points are rounded to 2^-20 voxel of a grid; hexahedra are split for it. A point
/// moves by the mean of the displacements of its cell's nodes, weighted by its barycentric
/// coordinates, in a hexahedron by the trilinear weights: points stay where nodes do.
///
/// Points that are not finite, or over 2^40 voxels from the grid, are held by no cell.
/// @param mesh      rest state
/// @param deformed  positions of its nodes [world]
/// @param points    in the rest mesh, with `inverse` in the deformed one [world]
/// @throws std::invalid_argument  on a bad mesh, grid or option; nodes over 2^40 voxels from the
///         grid, cells of more than 2^20 of its voxels
/// @throws CudaError              when `backend` is cuda and the device is not usable
TETWARP_EXPORT MappedPoints map_points(const Mesh& mesh,
                                       const std::vector<Point3>& deformed,
                                       std::vector<Point3> points,
                                       const MapPointsOptions& options = {});

/// By the curved maps of tetrahedra of ten nodes, see CurvedMesh; its voxels are those of
/// MapPointsOptions::grid. Shapes, units and errors as above.
/// @throws std::invalid_argument  also what check_mid_nodes() throws
TETWARP_EXPORT MappedPoints map_points(const CurvedMesh& mesh,
                                       const std::vector<Point3>& deformed,
                                       std::vector<Point3> points,
                                       const MapPointsOptions& options = {});

}  // namespace tetwarp

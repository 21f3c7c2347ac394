/// @file surface.hpp
/// Triangle surfaces of images and meshes, their binding to tetrahedra, and meshes of surfaces.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <tetwarp/export.hpp>
#include <tetwarp/mesh.hpp>
#include <tetwarp/scene.hpp>
#include <tetwarp/volume.hpp>

namespace tetwarp {

/// The isosurface at a value of a volume of one component, by marching tetrahedra on the voxels'
/// centers: closed, with triangles counter-clockwise from the side of the lower samples. Where the
/// foreground (samples >= value) reaches the border of the volume, the surface ends half a voxel
/// beyond the outermost centers.
/// @param triangles  about how many: the volume is sampled on a coarser lattice; nothing: as many
/// as
///                   there are
/// @throws std::invalid_argument  a bad volume, no foreground, `triangles` below 4
TETWARP_EXPORT Surface make_isosurface(const Volume& volume,
                                       double value,
                                       std::optional<std::int64_t> triangles = {});

/// The triangles that one tetrahedron of a mesh alone has, counter-clockwise from outside, and the
/// nodes that they use.
/// @throws std::invalid_argument  hexahedra, a tetrahedron without volume, as check_mesh()
TETWARP_EXPORT Surface boundary_surface(const Mesh& mesh);

/// Points as weighted means of the nodes of the nearest tetrahedron of a mesh.
struct BoundPoints {
  std::vector<std::array<std::int32_t, 4>> nodes;
  std::vector<std::array<double, 4>> weights;  ///< 0 to 1, of sum 1
  double largest_distance = 0;  ///< from a point to the mean of its nodes [world]; 0: all inside
};

/// The points of boundary_surface() as the nodes that they are: each has the weight 1 of its node,
/// in the first tetrahedron with it. Where parts of a mesh meet with nodes of their own, as at
/// cracks and between partitions, places do not tell these nodes apart.
/// @throws std::invalid_argument  as boundary_surface()
TETWARP_EXPORT BoundPoints bind_boundary(const Mesh& mesh);

/// @throws std::invalid_argument  no tetrahedron, points that are not finite, as check_mesh()
TETWARP_EXPORT BoundPoints bind_points(const Mesh& mesh, const std::vector<Point3>& points);

/// Cubes along the axes of the world, divided into five tetrahedra each, around a closed surface.
/// Kept are the tetrahedra that a triangle touches and those inside, so that they cover what the
/// surface encloses.
/// @param surface  closed, triangles counter-clockwise from outside
/// @param cells    cubes along the longest side of the surface's box, 1 at least
/// @throws std::invalid_argument  a surface that is not so, too many tetrahedra
TETWARP_EXPORT Mesh make_lattice_mesh(const Surface& surface, std::int64_t cells);

}  // namespace tetwarp

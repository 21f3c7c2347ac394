/// @file compose.hpp
/// Meshes and transforms joined to one displacement field.
#pragma once
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include <tetwarp/curved_mesh.hpp>
#include <tetwarp/export.hpp>
#include <tetwarp/resample.hpp>
#include <tetwarp/volume.hpp>
#include <tetwarp/warp.hpp>

namespace tetwarp {

/// A mesh and where its nodes are after a deformation. As a transform it takes positions back to
/// those at rest, as a warp looks for the sample of a voxel; what no cell holds keeps its place.
struct MovedMesh {
  CurvedMesh mesh;
  std::vector<Point3> deformed;  ///< of its nodes [world]
};

/// One of the transforms that compose() joins, from positions of the output to those in the source.
struct ComposeLink {
  std::variant<MovedMesh, Transform> transform;  ///< no TransformChain
  bool is_inverse = false;  ///< its inverse is meant; of an affine transform take inverse_of()
};

/// What kept positions from being moved, summed over the links.
struct ComposeNotes {
  std::int64_t outside = 0;       ///< of a mesh: they kept their place there
  std::int64_t straightened = 0;  ///< of a mesh: moved by straight tetrahedra, see CurvedMesh
  std::int64_t not_inverted = 0;  ///< of a field: no position is taken there; kept their place
  double largest_residual = 0;    ///< of those found [world]
};

/// Where compose_into() writes.
struct ComposeTarget {
  std::span<float> displacements;   ///< out, [k][j][i][3] [world]
  std::span<std::uint8_t> reached;  ///< out, as in ComposedField; may be empty
};

struct ComposedField {
  Volume field;                       ///< `tetwarp_displacement`, float32, along the world's axes
  std::vector<std::uint8_t> reached;  ///< per voxel: 0 if it kept its place in a link, else 1
  ComposeNotes notes;
};

/// The displacements of a chain of transforms at the voxels of a grid: position by position one
/// transform after the other, rounded to float32 once.
/// @param links     at least one; the first one is applied to positions of the output first
/// @param threads   0: all cores; any number gives the same bits
/// @param progress  may be empty
/// @throws std::invalid_argument  as map_points() and resample(); no link, or one that is not
///                                inverted here
/// @throws Cancelled              when `progress` returned false
TETWARP_EXPORT ComposedField compose(std::span<const ComposeLink* const> links,
                                     const Grid& grid,
                                     int threads,
                                     const Progress& progress = {});

/// compose() into memory of the caller: errors as there, and for arrays of another size.
TETWARP_EXPORT ComposeNotes compose_into(std::span<const ComposeLink* const> links,
                                         const Grid& grid,
                                         int threads,
                                         const ComposeTarget& target,
                                         const Progress& progress = {});

/// Memory that compose_into() takes with `displacements`, without meshes and transforms [byte].
TETWARP_EXPORT double compose_memory(const Grid& grid, int threads);

/// The inverse. Throws std::invalid_argument when the matrix is singular.
TETWARP_EXPORT AffineTransform inverse_of(const AffineTransform& affine);

}  // namespace tetwarp

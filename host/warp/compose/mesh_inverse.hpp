/// @file mesh_inverse.hpp
/// Whether a deformed mesh has an inverse: folds, and how near points come back.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/curved_mesh.hpp>
#include <tetwarp/export.hpp>

namespace tetwarp {

/// Counts that show whether a deformation has an inverse.
struct InverseCheck {
  std::int64_t inverted = 0;      ///< tetrahedra, of hexahedra their parts
  std::int64_t points = 0;        ///< nodes and centers that were moved there and back
  std::int64_t straightened = 0;  ///< most of either way: mapped by the straight tetrahedron
  std::int64_t folded = 0;        ///< of `points`: another cell maps to a different place
  std::int64_t beside = 0;        ///< of `points`: come back by a curved cell beside their own
  double beside_error = 0;        ///< largest of these [world]
  double largest_error = 0;       ///< of points that are none of the above [world]
};

/// Moves nodes and centers of cells from rest to the deformed positions and back, of curved cells
/// also the centers of their straight faces. The inverse itself is exact: the mesh with rest and
/// deformed positions exchanged.
/// @throws std::invalid_argument  as map_points()
TETWARP_EXPORT InverseCheck check_inverse(const CurvedMesh& mesh,
                                          const std::vector<Point3>& deformed);

}  // namespace tetwarp

/// @file voxel_owner.hpp
/// Which tetrahedron owns each voxel of an image at rest.
#pragma once
#include <cstdint>
#include <vector>

#include "host/scene/scene_geometry.hpp"
#include "host/scene/shapes/lattice.hpp"

namespace tetwarp {

/// Per voxel of a region of the volume's grid the lowest-numbered tetrahedron whose closed shape
/// contains the voxel's center, -1: none. Positions are rounded to 2^-20 voxel; then the decision
/// is exact, by the rule of Warper, which makes it.
std::vector<std::int32_t> voxel_owners(const Volume& volume,
                                       const Region& region,
                                       const TetMesh& mesh);

/// The tetrahedra of a body that own a voxel whose sample equals `value`, or share one where cells
/// are small, in ascending order.
std::vector<std::int32_t> tets_of_value(const Volume& volume,
                                        const BodyGeometry& geometry,
                                        double value);

}  // namespace tetwarp

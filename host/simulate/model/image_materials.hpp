/// @file image_materials.hpp
/// Moduli and masses of tetrahedra from the voxels of an image.
#pragma once
#include <cstddef>

#include "host/simulate/model/tet_materials.hpp"

namespace tetwarp {

/// Every foreground voxel counts once, for the tetrahedron that owns it: masses are sums of
/// density x volume x N_a N_b, moduli the means over voxels times the covered part of the volume,
/// which is taken as 0.02 at least.
TetMaterials image_materials(const BodyPart& part, const ModelTets& tets, std::size_t first_tet);

}  // namespace tetwarp

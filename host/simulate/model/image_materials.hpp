/// @file image_materials.hpp
/// Moduli and masses of tetrahedra from the voxels of an image.
#pragma once
#include <cstddef>
#include <deque>

#include "host/simulate/model/body_part.hpp"
#include "host/simulate/model/tet_materials.hpp"

namespace tetwarp {

struct ImageMaterials {
  TetMaterials tets;
  double foreground = 0;  ///< volume of the voxels at or above the threshold [m^3]
  double covered = 0;     ///< volume of their parts in tetrahedra [m^3]
};

/// Every voxel of the foreground counts once. Where cells are small, each tetrahedron has its exact
/// share of the voxel's box: masses are sums of the integrals of density N_a N_b over these parts.
/// Otherwise the voxel belongs to the tetrahedron that owns it: masses are sums of density x volume
/// x N_a N_b at the center. Moduli are the means over the parts times the covered part of the
/// tetrahedron's volume, which is taken as 0.02 at least.
class ImageMaterialsOfBodies {
 public:
  /// Those of an earlier body that is alike are given again, as images take long.
  /// @param part       its body is kept by the caller
  /// @param first_tet  of the body among `tets`
  const ImageMaterials& of(const BodyPart& part, const ModelTets& tets, std::size_t first_tet);

 private:
  struct Made {
    const Body* body;
    ImageMaterials materials;
  };
  std::deque<Made> made_;
};

}  // namespace tetwarp

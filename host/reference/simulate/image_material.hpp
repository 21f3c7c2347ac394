/// @file image_material.hpp
/// The voxels of an image that tetrahedra own, and the materials of their values.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "host/reference/simulate/vectors.hpp"

namespace tetwarp::reference {

/// A voxel of the foreground.
struct OwnedVoxel {
  Vector3d centre;  ///< frame of the image
  double value = 0;
};

/// Voxels of the foreground by the tetrahedron that owns them: the lowest-indexed one whose closed
/// shape contains the centre. Nodes are rounded to multiples of 2^-20 voxel and the decision is
/// made in integers of it, so that a centre on a common face has one owner.
std::vector<std::vector<OwnedVoxel>> owned_voxels(
    const ImageGeometry& image,
    const std::vector<Point3>& nodes,
    const std::vector<std::array<std::int32_t, 4>>& tets);

/// The value of the voxel that contains a point; outside the image that of the nearest voxel.
double value_at(const Volume& volume, const Vector3d& point);

/// What a body is made of where its image has a value; nothing where it is void.
std::optional<Material> material_at(const Body& body, double value);

}  // namespace tetwarp::reference

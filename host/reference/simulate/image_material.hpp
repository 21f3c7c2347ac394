/// @file image_material.hpp
/// The voxels of an image that tetrahedra own or share, and the materials of their values.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "host/reference/simulate/vectors.hpp"

namespace tetwarp::reference {

/// A voxel of the foreground in a tetrahedron.
struct HeldVoxel {
  double value = 0;
  double share = 0;          ///< of the voxel in the tetrahedron, 0 to 1
  Eigen::Matrix4d products;  ///< integrals of N_a N_b over this share, over the voxel's volume
};

/// Voxels of the foreground by the tetrahedron that owns them: the lowest-indexed one whose closed
/// shape contains the center. Nodes are rounded to multiples of 2^-20 voxel and the decision is
/// made in integers of it, so that a center on a common face has one owner. Products are those at
/// the center.
std::vector<std::vector<HeldVoxel>> owned_voxels(
    const ImageGeometry& image,
    const std::vector<Point3>& nodes,
    const std::vector<std::array<std::int32_t, 4>>& tets);

/// Voxels of the foreground by all tetrahedra that share their boxes: tetrahedra are cut at the
/// planes between voxels into smaller ones.
std::vector<std::vector<HeldVoxel>> shared_voxels(
    const ImageGeometry& image,
    const std::vector<Point3>& nodes,
    const std::vector<std::array<std::int32_t, 4>>& tets);

/// What a body is made of where its image has a value; nothing where it is void.
std::optional<Material> material_at(const Body& body, double value);

}  // namespace tetwarp::reference

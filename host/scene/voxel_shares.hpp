/// @file voxel_shares.hpp
/// The shares of tetrahedra in the boxes of voxels.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include <tetwarp/volume.hpp>

#include "host/base/point3.hpp"
#include "kernels/warp/overlap/voxel_share.hpp"

namespace tetwarp {

/// i, j, k.
using VoxelIndex = std::array<std::int64_t, 3>;

/// Positions in voxels of a grid.
std::vector<Point3> index_positions(const Grid& grid, const std::vector<Point3>& points_world);

/// Calls visit(voxel, share) for the voxels of a region in which a tetrahedron has a share, in
/// order, until it returns false. Shares of less than 1e-10 of the smaller of both are rounding.
/// @param corners  of the tetrahedron, not flat [voxel]
/// @param wants    whether to visit a voxel; others are left out
void for_shares(const std::array<Point3, 4>& corners,
                const Region& region,
                const std::function<bool(const VoxelIndex&)>& wants,
                const std::function<bool(const VoxelIndex&, const VoxelShare&)>& visit);

/// Whether a tetrahedron has a share in any voxel that is wanted.
bool has_share(const std::array<Point3, 4>& corners,
               const Region& region,
               const std::function<bool(const VoxelIndex&)>& wants);

}  // namespace tetwarp

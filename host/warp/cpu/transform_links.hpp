/// @file transform_links.hpp
/// Transforms in the form that kernels read.
#pragma once
#include <span>
#include <vector>

#include <tetwarp/resample.hpp>

#include "host/warp/resample_part.hpp"
#include "kernels/warp/sample/transform_link.hpp"

namespace tetwarp {

/// The links of a transform, in the order in which they are applied. They refer to its memory.
/// @param windows  the displacements of fields, to whose memory they then refer: one per link, or
///                 none, where the fields hold them
/// @throws std::invalid_argument  a number that is not finite, a bad grid, another number of
///         displacements or coefficients than the grid needs, a chain without links
std::vector<TransformLink> links_of(const Transform& transform,
                                    std::span<const FieldWindow> windows = {});

/// The same transform by fewer links: affine ones that follow each other become one, and those that
/// move nothing none. The result may be empty.
std::vector<TransformLink> folded(const std::vector<TransformLink>& links);

/// The grid of the first field or spline of a transform; null: it has none.
const Grid* first_grid(const Transform& transform);

/// From indices of a grid to the world.
IndexAffine world_map(const Grid& grid);

/// From the world to indices of a grid.
IndexAffine index_map(const Grid& grid);

/// From output indices to those of another grid at the same place in the world; whole-voxel shifts
/// are exact.
IndexAffine between_grids(const Grid& other, const Grid& output);

/// a after b.
IndexAffine composed(const IndexAffine& a, const IndexAffine& b);

/// x -> matrix x + offset.
IndexAffine affine_map(const AffineTransform& affine);

}  // namespace tetwarp

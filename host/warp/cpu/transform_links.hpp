/// @file transform_links.hpp
/// Transforms in the form that kernels read.
#pragma once
#include <vector>

#include <tetwarp/resample.hpp>

#include "kernels/warp/transform_link.hpp"

namespace tetwarp {

/// The links of a transform, in the order in which they are applied. They refer to its memory.
/// @throws std::invalid_argument  a number that is not finite, a bad grid, another number of
///         displacements or coefficients than the grid needs, a chain without links
std::vector<TransformLink> links_of(const Transform& transform);

/// The same transform by fewer links: affine ones that follow each other become one, and those that
/// move nothing none. The result may be empty.
std::vector<TransformLink> folded(const std::vector<TransformLink>& links);

/// The grid of the first field or spline of a transform; null: it has none.
const Grid* first_grid(const Transform& transform);

/// a after b.
IndexAffine composed(const IndexAffine& a, const IndexAffine& b);

/// x -> matrix x + offset.
IndexAffine affine_map(const AffineTransform& affine);

}  // namespace tetwarp

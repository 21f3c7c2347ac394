/// @file field_inverse.hpp
/// Positions that a displacement field or a spline takes to given ones.
#pragma once
#include <cstddef>
#include <functional>
#include <vector>

#include <tetwarp/export.hpp>
#include <tetwarp/resample.hpp>

namespace tetwarp {

/// What an inverse found.
struct FieldInverse {
  std::vector<std::size_t> not_found;  ///< numbers of the positions that kept their place
  double largest_residual = 0;         ///< of the others [world]
};

/// Replaces each y of `points` by an x with |x + u(x) - y| of at most 1e-6 of the smallest spacing,
/// by Newton's method with halved steps from x = y. Where that fails, it begins again in each cell
/// of the field that may be taken to a box around y, so no bound on the derivatives of u is needed.
/// A y without such an x stays as it is. Any number of threads gives the same bits.
/// @param field     a DisplacementField or a BSplineTransform
/// @param progress  called several times a second; may be empty, may throw to end it
TETWARP_EXPORT FieldInverse invert_field(const Transform& field,
                                         std::vector<Point3>& points,
                                         int threads,
                                         const std::function<void()>& progress = {});

}  // namespace tetwarp

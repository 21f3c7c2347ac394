/// @file field_inverse.hpp
/// Positions that a displacement field or a spline takes to given ones.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include <tetwarp/resample.hpp>

namespace tetwarp::cli {

/// What an inverse found.
struct InverseCounts {
  std::int64_t not_found = 0;   ///< positions that kept their place
  double largest_residual = 0;  ///< of the others [world]
};

/// Replaces each y of `points` by an x with |x + u(x) - y| of at most 1e-6 of the smallest spacing,
/// by Newton's method with halved steps from x = y. Where that fails, it begins again in each cell
/// of the field that may be taken to a box around y, so no bound on the derivatives of u is needed.
/// A y without such an x stays as it is.
/// @param field     a DisplacementField or a BSplineTransform
/// @param progress  called several times a second; may be empty, may throw to end it
InverseCounts invert_field(const Transform& field,
                           std::vector<Point3>& points,
                           const std::function<void()>& progress = {});

}  // namespace tetwarp::cli

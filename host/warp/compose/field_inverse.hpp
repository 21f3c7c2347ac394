/// @file field_inverse.hpp
/// Positions that a displacement field or a spline takes to given ones.
#pragma once
#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include <tetwarp/export.hpp>
#include <tetwarp/resample.hpp>

#include "host/warp/compose/image_cells.hpp"

namespace tetwarp {

/// What an inverse found.
struct InverseResult {
  std::vector<std::size_t> not_found;  ///< numbers of the positions that kept their place
  double largest_residual = 0;         ///< of the others [world]
};

/// The inverse of x -> x + u(x), by Newton's method with halved steps from x = y. Where that fails,
/// it begins again in each cell of the field that may be taken to a box around y, so no bound on
/// the derivatives of u is needed. Source: Newton's method with a line search; the cells are ours.
class TETWARP_EXPORT FieldInverse {
 public:
  /// @param field  a DisplacementField or a BSplineTransform, kept by the caller
  explicit FieldInverse(const Transform& field) : field_(field) {}
  explicit FieldInverse(Transform&&) = delete;

  /// Replaces each y of `points` by an x with |x + u(x) - y| of at most 1e-6 of the smallest
  /// spacing. A y without such an x stays as it is. Any number of threads gives the same bits.
  /// @param threads   0: all processors
  /// @param progress  called several times a second by the calling thread; may be empty, may throw
  ///                  to end it
  InverseResult apply(std::vector<Point3>& points,
                      int threads,
                      const std::function<void()>& progress = {});

 private:
  const Transform& field_;
  std::unique_ptr<const ImageCells> cells_;  ///< made when a point first needs them
};

}  // namespace tetwarp

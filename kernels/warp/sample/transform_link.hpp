/// @file transform_link.hpp
/// Where an affine map, a field of displacements or a spline takes a point.
#pragma once
#include <cstdint>

#include "kernels/base/hd.hpp"
#include "kernels/base/index_space.hpp"

namespace tetwarp {

/// An affine map between index spaces, or from the world to one.
struct IndexAffine {
  double linear[3][3];
  double offset[3];

  TETWARP_HD void map(const double* x, double* y) const {
    for (int row = 0; row < 3; ++row) {
      const double* const m = linear[row];
      y[row] = m[0] * x[0] + m[1] * x[1] + m[2] * x[2] + offset[row];
    }
  }
};

/// Vectors on a grid, or those of a window of it. No position within the grid is sampled that
/// reads vectors beyond the window.
struct FieldView {
  const float* vectors = nullptr;    ///< [k][j][i][3], world; null: there is no field
  std::int64_t dims[3] = {0, 0, 0};  ///< of the grid
  std::int64_t size[3] = {0, 0, 0};  ///< of the window
  std::int64_t first = 0;            ///< place() of the window's first voxel

  /// Of a voxel of the grid in an array that has the window's size and begins at voxel (0, 0, 0).
  TETWARP_HD std::int64_t place(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return i + size[0] * (j + size[1] * k);
  }
  TETWARP_HD const float* at(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return vectors + 3 * (place(i, j, k) - first);
  }

  /// The vector at an index position, linear between centers, constant for the last half voxel.
  /// @returns false beyond that; the vector is then zero
  TETWARP_HD bool sample(const double* index, double* vector) const {
    std::int64_t lower[3], upper[3];
    double fraction[3];
    for (int axis = 0; axis < 3; ++axis) {
      vector[axis] = 0;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const double last = static_cast<double>(dims[axis] - 1);
      if (!(index[axis] >= -0.5 && index[axis] <= last + 0.5)) return false;
      const double near = min_of(max_of(index[axis], 0.0), last);
      lower[axis] = static_cast<std::int64_t>(near);
      upper[axis] = min_of(lower[axis] + 1, dims[axis] - 1);
      fraction[axis] = near - static_cast<double>(lower[axis]);
    }
    for (int corner = 0; corner < 8; ++corner) {
      double weight = 1;
      std::int64_t place[3];
      for (int axis = 0; axis < 3; ++axis) {
        const bool is_upper = (corner >> axis & 1) != 0;
        weight *= is_upper ? fraction[axis] : 1 - fraction[axis];
        place[axis] = is_upper ? upper[axis] : lower[axis];
      }
      if (weight == 0) continue;  // so that a NaN there does not spread
      const float* const v = at(place[0], place[1], place[2]);
      for (int axis = 0; axis < 3; ++axis) vector[axis] += weight * static_cast<double>(v[axis]);
    }
    return true;
  }
};

/// Weights of the four coefficients around a position, t from the second one.
TETWARP_HD void set_cubic_weights(double t, double* weights) {
  const double s = 1 - t;
  weights[0] = s * s * s / 6;
  weights[1] = (4 - 6 * t * t + 3 * t * t * t) / 6;
  weights[2] = (4 - 6 * s * s + 3 * s * s * s) / 6;
  weights[3] = t * t * t / 6;
}

/// Vectors of a cubic B-spline with uniform knots.
struct SplineView {
  const double* coefficients = nullptr;  ///< [k][j][i][3], world; null: there is no spline
  std::int64_t dims[3] = {0, 0, 0};      ///< at least 4 each

  /// The vector at an index position of the coefficients.
  /// @returns false where not all 4 x 4 x 4 coefficients are there; the vector is then zero
  TETWARP_HD bool sample(const double* index, double* vector) const {
    std::int64_t first[3];
    double weights[3][4];
    for (int axis = 0; axis < 3; ++axis) {
      vector[axis] = 0;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const double last = static_cast<double>(dims[axis] - 2);
      constexpr double rounding = 1e-9;  // of positions on the rim
      if (!(index[axis] >= 1 - rounding && index[axis] <= last + rounding)) return false;
      const double near = min_of(max_of(index[axis], 1.0), last);
      const std::int64_t lower = min_of(static_cast<std::int64_t>(near), dims[axis] - 3);
      first[axis] = lower - 1;
      set_cubic_weights(near - static_cast<double>(lower), weights[axis]);
    }
    for (int c = 0; c < 4; ++c) {
      for (int b = 0; b < 4; ++b) {
        const std::int64_t row = (first[2] + c) * dims[1] + first[1] + b;
        const double* const v = coefficients + 3 * (row * dims[0] + first[0]);
        const double weight = weights[2][c] * weights[1][b];
        for (int a = 0; a < 4; ++a) {
          for (int axis = 0; axis < 3; ++axis) {
            vector[axis] += weight * weights[0][a] * v[3 * a + axis];
          }
        }
      }
    }
    return true;
  }
};

/// One of several transforms of the world that follow each other: x -> affine(x) where there is
/// neither field nor spline, else x + vector(x).
struct TransformLink {
  IndexAffine affine;
  IndexFromWorld to_index;  ///< of the grid of the field or of the coefficients
  FieldView field;
  SplineView spline;

  TETWARP_HD bool is_affine() const {
    return field.vectors == nullptr && spline.coefficients == nullptr;
  }

  /// @returns false where x is beyond a field or a spline, which then leaves it where it is
  TETWARP_HD bool move(double* x) const {
    if (is_affine()) {
      const double from[3] = {x[0], x[1], x[2]};
      affine.map(from, x);
      return true;
    }
    double index[3];
    for (int row = 0; row < 3; ++row) {
      index[row] = 0;
      for (int axis = 0; axis < 3; ++axis) {
        index[row] += to_index.linear[row][axis] * (x[axis] - to_index.origin[axis]);
      }
    }
    return move_at(index, x);
  }

  /// move() of a point at an index position of the grid. @pre not is_affine()
  TETWARP_HD bool move_at(const double* index, double* x) const {
    double vector[3];
    const bool is_inside =
        field.vectors != nullptr ? field.sample(index, vector) : spline.sample(index, vector);
    for (int axis = 0; axis < 3; ++axis) x[axis] += vector[axis];
    return is_inside;
  }
};

}  // namespace tetwarp

/// @file transforms.hpp
/// Affine transforms and displacement fields from what the package passes.
#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/pair.h>

#include <cstddef>
#include <tetwarp/resample.hpp>
#include <utility>

#include "python/arrays.hpp"

namespace tetwarp::python {

using InMatrix = In<double, nb::shape<4, 4>>;

inline AffineTransform affine_of(const InMatrix& matrix) {
  AffineTransform affine;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      affine.matrix[3 * row + column] = matrix(row, column);
    }
    affine.offset[row] = matrix(row, 3);
  }
  return affine;
}

/// @param given  an array of shape (4, 4), or a pair of a grid and displacements (z, y, x, 3)
/// @param Kind   SingleTransform or Transform
template <class Kind>
Kind transform_of(const nb::handle& given) {
  if (!nb::isinstance<nb::tuple>(given)) return affine_of(nb::cast<InMatrix>(given));
  const auto [grid, values] = nb::cast<std::pair<Grid, In<float>>>(given);
  return DisplacementField{grid, vector_of(values)};
}

}  // namespace tetwarp::python

/// @file small_cholesky.hpp
/// Solves symmetric positive definite systems of a few unknowns in place.
#pragma once
#include "kernels/base/hd.hpp"

namespace tetwarp {

/// Solves G x = p by Cholesky factorization.
/// @param gram  G in the upper left `size` rows and columns; overwritten
/// @param size  number of unknowns, at most `most`
/// @param x     in: p; out: the solution
/// @returns whether G is positive definite; if not, x is undefined
template <int most>
TETWARP_HD_RARE bool solve_small_spd(double (&gram)[most][most], int size, double (&x)[most]) {
  for (int j = 0; j < size; ++j) {
    double pivot = gram[j][j];
    for (int k = 0; k < j; ++k) pivot -= gram[j][k] * gram[j][k];
    if (!(pivot > 0)) return false;
    pivot = sqrt(pivot);
    gram[j][j] = pivot;
    for (int i = j + 1; i < size; ++i) {
      double sum = gram[i][j];
      for (int k = 0; k < j; ++k) sum -= gram[i][k] * gram[j][k];
      gram[i][j] = sum / pivot;
    }
    double sum = x[j];
    for (int k = 0; k < j; ++k) sum -= gram[j][k] * x[k];
    x[j] = sum / pivot;
  }
  for (int j = size; j-- > 0;) {
    double sum = x[j];
    for (int k = j + 1; k < size; ++k) sum -= gram[k][j] * x[k];
    x[j] = sum / gram[j][j];
  }
  return true;
}

}  // namespace tetwarp

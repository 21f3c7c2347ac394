/// @file symmetric_eigen.hpp
/// Eigenvectors of small symmetric matrices.
#pragma once
#include "kernels/base/hd.hpp"

namespace tetwarp {

/// Diagonalizes a symmetric matrix by cyclic Jacobi rotations. Eigenvectors are orthonormal to
/// rounding for any eigenvalues. Stops after ten sweeps at most, also on NaN.
/// @param a        in: the matrix, both triangles; out: eigenvalues on the diagonal, unsorted
/// @param vectors  out: column k is the eigenvector of a[k][k]
/// Source: C. G. J. Jacobi, 1846.
template <int size>
TETWARP_HD_RARE void symmetric_eigen(double (*a)[size], double (*vectors)[size]) {
  double largest = 0;
  for (int p = 0; p < size; ++p) {
    for (int q = 0; q < size; ++q) {
      vectors[p][q] = p == q ? 1 : 0;
      largest = max_of(largest, fabs(a[p][q]));
    }
  }
  bool has_turned = true;
  for (int sweep = 0; sweep < 10 && has_turned; ++sweep) {
    has_turned = false;
    for (int p = 0; p < size; ++p) {
      for (int q = p + 1; q < size; ++q) {
        if (fabs(a[p][q]) <= 0x1p-64 * largest) continue;
        has_turned = true;
        const double slope = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double tangent = copysign(1 / (fabs(slope) + sqrt(slope * slope + 1)), slope);
        const double cosine = 1 / sqrt(tangent * tangent + 1), sine = tangent * cosine;
        for (int r = 0; r < size; ++r) {  // columns p and q
          const double at_p = a[r][p], at_q = a[r][q];
          a[r][p] = cosine * at_p - sine * at_q;
          a[r][q] = sine * at_p + cosine * at_q;
          const double v_p = vectors[r][p], v_q = vectors[r][q];
          vectors[r][p] = cosine * v_p - sine * v_q;
          vectors[r][q] = sine * v_p + cosine * v_q;
        }
        for (int r = 0; r < size; ++r) {  // rows p and q
          const double at_p = a[p][r], at_q = a[q][r];
          a[p][r] = cosine * at_p - sine * at_q;
          a[q][r] = sine * at_p + cosine * at_q;
        }
        a[p][q] = a[q][p] = 0;
      }
    }
  }
}

}  // namespace tetwarp

/// @file contact_setup.hpp
/// Stage "setup" of the contact solver: inverse diagonal blocks of A, responses A^-1 J^T, and the
/// 3x3 Delassus block of each contact.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/contact/contact_law.hpp"

namespace tetwarp {

/// Pairs of a contact and a block of dofs that it acts on. The Jacobian part of a pair is 3 x size,
/// its response part size x 3, both row by row and from the same start.
struct PairView {
  View<const std::int64_t> pair_start;   ///< [contacts + 1], first pair of each contact
  View<const std::int32_t> block;        ///< [pairs]
  View<const std::int64_t> value_start;  ///< [pairs], in the Jacobian and in the responses
  View<const std::int64_t> dof_start;    ///< [blocks + 1], first dof of each block
  bool operator==(const PairView&) const = default;
};

/// Inverts a symmetric positive definite matrix in place: Gauss-Jordan without pivoting.
template <class T>
TETWARP_HD void invert_spd(T* a, int size) {
  for (int k = 0; k < size; ++k) {
    const T pivot = 1 / a[k * size + k];
    for (int i = 0; i < size; ++i) {
      if (i == k) continue;
      const T factor = a[i * size + k] * pivot;
      for (int j = 0; j < size; ++j) {
        if (j != k) a[i * size + j] -= factor * a[k * size + j];
      }
      a[i * size + k] = -factor;
    }
    for (int j = 0; j < size; ++j) a[k * size + j] *= pivot;
    a[k * size + k] = pivot;
  }
}

/// One index = one block: its inverse, in place.
template <class T>
struct BlockInvertOp {
  View<const std::int64_t> dof_start;
  View<const std::int64_t> value_start;  ///< [blocks + 1], first entry of each block
  View<T> values;

  TETWARP_HD void operator()(std::int64_t b) const {
    invert_spd(values.data + value_start[b], static_cast<int>(dof_start[b + 1] - dof_start[b]));
  }
};

/// One index = one contact: the velocities of its blocks for unit impulses, times `relaxation`, and
/// its own block of the Delassus matrix.
template <class T>
struct ContactResponseOp {
  PairView pairs;
  View<const T> jacobian;
  View<const std::int64_t> inverse_start;
  View<const T> inverse;
  T relaxation;
  View<T> response;
  View<ContactConstants<T>> constants;

  TETWARP_HD void operator()(std::int64_t c) const {
    T* own = constants[c].block;
    for (int e = 0; e < 9; ++e) own[e] = 0;
    for (std::int64_t p = pairs.pair_start[c]; p < pairs.pair_start[c + 1]; ++p) {
      const std::int32_t b = pairs.block[p];
      const int size = static_cast<int>(pairs.dof_start[b + 1] - pairs.dof_start[b]);
      const T* j = jacobian.data + pairs.value_start[p];
      const T* inverse_block = inverse.data + inverse_start[b];
      T* own_response = response.data + pairs.value_start[p];
      for (int row = 0; row < size; ++row) {
        for (int a = 0; a < 3; ++a) {
          T sum = 0;
          for (int k = 0; k < size; ++k) sum += inverse_block[row * size + k] * j[a * size + k];
          own_response[3 * row + a] = relaxation * sum;
        }
      }
      for (int a = 0; a < 3; ++a) {
        for (int e = 0; e < 3; ++e) {
          for (int k = 0; k < size; ++k)
            own[3 * a + e] += j[a * size + k] * own_response[3 * k + e];
        }
      }
    }
  }
};

/// One index = one contact: the scalar metric of its tangents, computed from its block.
template <class T>
struct ContactMetricOp {
  View<ContactConstants<T>> constants;

  TETWARP_HD void operator()(std::int64_t c) const {
    const T* b = constants[c].block;
    constants[c].tangent_metric = larger_eigenvalue(b[4], (b[5] + b[7]) / 2, b[8]);
  }
};

}  // namespace tetwarp

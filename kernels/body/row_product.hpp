/// @file row_product.hpp
/// Products with the 3x3 blocks of the system, and the inverse of its block diagonal.
#pragma once
#include <cstdint>

#include "kernels/base/small_cholesky.hpp"
#include "kernels/base/view.hpp"
#include "kernels/body/lane_math.hpp"
#include "kernels/body/system_lists.hpp"

namespace tetwarp {

/// y = sum of the blocks at places [begin, end) times their columns of x. The three products of a
/// row of a block are added to each other before they are added to the sum, so that vectors of any
/// width give the same bits.
template <class T, class X>
TETWARP_HD void multiply_blocks(const T* values,
                                const std::int32_t* column,
                                std::int64_t begin,
                                std::int64_t end,
                                const X* x,
                                X* y) {
  X sum[3] = {};
  for (std::int64_t k = begin; k < end; ++k) {
    const T* const a = values + 9 * k;
    const X* const own = x + 3 * std::int64_t{column[k]};
    for (int i = 0; i < 3; ++i) sum[i] += a[i] * own[0] + a[3 + i] * own[1] + a[6 + i] * own[2];
  }
  for (int i = 0; i < 3; ++i) y[i] = sum[i];
}

/// The inverse of a symmetric positive definite 3x3 matrix; zero if it is not positive.
TETWARP_HD void invert3(const double* a, double* inverse) {
  const double c00 = a[4] * a[8] - a[5] * a[5], c01 = a[2] * a[5] - a[1] * a[8];
  const double c02 = a[1] * a[5] - a[2] * a[4], c11 = a[0] * a[8] - a[2] * a[2];
  const double c12 = a[1] * a[2] - a[0] * a[5], c22 = a[0] * a[4] - a[1] * a[1];
  const double det = a[0] * c00 + a[1] * c01 + a[2] * c02;
  const double f = det > 0 ? 1 / det : 0;
  inverse[0] = f * c00, inverse[1] = inverse[3] = f * c01, inverse[2] = inverse[6] = f * c02;
  inverse[4] = f * c11, inverse[5] = inverse[7] = f * c12, inverse[8] = f * c22;
}

/// Inverses of the diagonal blocks: 3x3 of nodes, 6x6 of the two rows of a rigid body.
template <class T>
struct DiagonalInverse {
  View<const std::uint8_t> pair;       ///< SystemRows::pair
  View<const std::int32_t> block_of;   ///< SystemRows::block_of
  std::int64_t row_count, node_count;  ///< rows with unknowns; blocks before those of rigid bodies
  View<T> values;                      ///< [row_count][9], then [rigid][36]

  /// The numbers of a row; of a pair those at its first row.
  TETWARP_HD T* at(std::int64_t row) const {
    if (pair[row] == 0) return values.data + 9 * row;
    return values.data + 9 * row_count + 18 * (block_of[row] - node_count);
  }

  /// z = D^-1 r in the row; of a pair in both rows at the first one and nothing at the second.
  /// @returns how many numbers were written
  TETWARP_HD int multiply(std::int64_t row, const T* r, T* z) const {
    const T* const a = at(row);
    if (pair[row] == 0) {
      for (int i = 0; i < 3; ++i)
        z[i] = a[3 * i] * r[0] + a[3 * i + 1] * r[1] + a[3 * i + 2] * r[2];
      return 3;
    }
    if (pair[row] == 2) return 0;
    for (int i = 0; i < 6; ++i) {
      T sum = 0;
      for (int j = 0; j < 6; ++j) sum += a[6 * i + j] * r[j];
      z[i] = sum;
    }
    return 6;
  }
};

/// One index = one row with unknowns.
template <class T>
struct RowInvertOp {
  SystemRows rows;
  View<const double> values;
  DiagonalInverse<T> inverse;  ///< out

  TETWARP_HD void operator()(std::int64_t row) const {
    T* const out = inverse.at(row);
    if (rows.pair[row] == 0) {
      double own[9];
      invert3(values.data + 9 * std::int64_t{rows.diagonal[row]}, own);
      for (int i = 0; i < 9; ++i) out[i] = static_cast<T>(own[i]);
    } else if (rows.pair[row] == 1) {
      invert_pair(row, out);
    }
  }
  TETWARP_HD void invert_pair(std::int64_t row, T* out) const {
    const double* const corner[3] = {values.data + 9 * std::int64_t{rows.diagonal[row]},
                                     values.data + 9 * std::int64_t{rows.diagonal[row] + 1},
                                     values.data + 9 * std::int64_t{rows.diagonal[row + 1]}};
    for (int c = 0; c < 6; ++c) {
      double a[6][6], x[6];
      for (int i = 0; i < 6; ++i) {
        x[i] = i == c ? 1 : 0;
        for (int j = 0; j <= i; ++j) {
          // The block above the diagonal is corner[1], column-major: below it is row-major.
          a[i][j] = i < 3    ? corner[0][3 * j + i]
                    : j >= 3 ? corner[2][3 * (j - 3) + i - 3]
                             : corner[1][3 * (i - 3) + j];
        }
      }
      const bool is_solved = solve_small_spd(a, 6, x);
      for (int i = 0; i < 6; ++i) out[6 * i + c] = is_solved ? static_cast<T>(x[i]) : T(0);
    }
  }
};

/// One index = one row with unknowns: moves the prescribed columns to the right-hand side.
struct RowPrescribedOp {
  SystemRows rows;
  View<const double> values, velocity;  ///< velocity: [rows][3]
  View<double> load;                    ///< in, out

  TETWARP_HD void operator()(std::int64_t row) const {
    if (rows.free_end[row] == rows.start[row + 1]) return;
    double known[3];
    multiply_blocks(values.data, rows.column.data, rows.free_end[row], rows.start[row + 1],
                    velocity.data, known);
    for (int i = 0; i < 3; ++i) load[3 * row + i] -= known[i];
  }
};

/// One index = one prescribed row: A v - b, the impulse that keeps its velocity.
struct RowSupportOp {
  SystemRows rows;
  View<const double> values, velocity, load;
  View<double> impulse;  ///< out, [blocks][3]

  TETWARP_HD void operator()(std::int64_t k) const {
    const std::int64_t row = rows.unknown_count + k;
    double product[3];
    multiply_blocks(values.data, rows.column.data, rows.start[row], rows.start[row + 1],
                    velocity.data, product);
    for (int i = 0; i < 3; ++i) {
      impulse[3 * std::int64_t{rows.block_of[row]} + i] = product[i] - load[3 * row + i];
    }
  }
};

/// One index = one row: copies the velocity of its block; prescribed blocks have given ones.
struct RowVelocityOp {
  SystemRows rows;
  View<const double> block_velocity, prescribed;  ///< [blocks][3]
  View<double> velocity;                          ///< out, [rows][3]

  TETWARP_HD void operator()(std::int64_t row) const {
    const std::int64_t block = rows.block_of[row];
    const View<const double>& from = row < rows.unknown_count ? block_velocity : prescribed;
    for (int i = 0; i < 3; ++i) velocity[3 * row + i] = from[3 * block + i];
  }
};
/// One index = one row: the inverse of RowVelocityOp.
struct BlockVelocityOp {
  SystemRows rows;
  View<const double> velocity;
  View<double> block_velocity;  ///< out

  TETWARP_HD void operator()(std::int64_t row) const {
    const std::int64_t block = rows.block_of[row];
    for (int i = 0; i < 3; ++i) block_velocity[3 * block + i] = velocity[3 * row + i];
  }
};

}  // namespace tetwarp

/// @file resident_results.hpp
/// Results of a problem in the order of the problem's arrays, and sums that check them. Products
/// and sums of velocities are rounded one by one, so that they have the same bits as on the host.
#pragma once
#include <cstdint>

#include "kernels/base/plain_sums.hpp"
#include "kernels/base/view.hpp"
#include "kernels/contact/body_relax.hpp"
#include "kernels/contact/resident_checks.hpp"

namespace tetwarp {

/// One index = one contact: raises its normal offset to at least -speed.
struct RecoveryOp {
  View<const double> given;
  double speed;
  View<double> out;

  TETWARP_HD void operator()(std::int64_t c) const {
    out[3 * c] = given[3 * c] < -speed ? -speed : given[3 * c];
    out[3 * c + 1] = given[3 * c + 1];
    out[3 * c + 2] = given[3 * c + 2];
  }
};

/// One index = one place: copies its `width` numbers to the place of its item.
template <int width>
struct ScatterItemsOp {
  View<const std::int32_t> item;
  View<const double> in;
  View<double> out;

  TETWARP_HD void operator()(std::int64_t i) const {
    for (int k = 0; k < width; ++k) out[width * std::int64_t{item[i]} + k] = in[width * i + k];
  }
};

/// One index = one row: out = offset + matrix x.
struct RowResultOp {
  RowsView rows;
  View<const double> values, x, offset;
  View<double> out;

  TETWARP_HD void operator()(std::int64_t row) const {
    double sum = offset[row];
    for (std::int64_t e = rows.row_start[row]; e < rows.row_start[row + 1]; ++e) {
      sum = add_rn(sum, mul_rn(values[e], x[rows.column[e]]));
    }
    out[row] = sum;
  }
};

/// Sums over a result.
struct ResultSums {
  PlainSums<4> sums;  ///< numbers that are not finite; squares of A v - J^T r - b, J^T r, b

  TETWARP_HD double bad() const { return sums.value[0]; }
  /// |A v - J^T r - b| over the larger of |J^T r| and |b|; infinity where it is not finite.
  double balance() const {
    const double scale = sqrt(max_of(sums.value[2], sums.value[3]));
    const double ratio = sqrt(sums.value[1]) / max_of(scale, 0x1p-1022);
    return ratio < INFINITY && scale < INFINITY ? ratio : INFINITY;
  }
  TETWARP_HD ResultSums& operator+=(const ResultSums& other) {
    sums += other.sums;
    return *this;
  }
};

TETWARP_HD double not_finite(double value) {
  return fabs(value) < INFINITY ? 0.0 : 1.0;
}

/// One index = one row of contacts.
struct ContactResultOp {
  View<const double> impulse, velocity;

  TETWARP_HD ResultSums operator()(std::int64_t row) const {
    return {{{not_finite(impulse[row]) + not_finite(velocity[row]), 0, 0, 0}}};
  }
};

/// One index = one block of dofs.
struct BalanceSumsOp {
  SystemView<double> system;
  BlockContacts contacts;
  View<const double> jacobian;  ///< by pairs
  View<const double> load;      ///< [dofs], by places like the velocities
  View<const double> impulse;   ///< [3 slots]
  View<const double> body_velocity;

  TETWARP_HD ResultSums operator()(std::int64_t b) const {
    const std::int64_t first = system.dof_start[b], size = system.dof_start[b + 1] - first;
    ResultSums sums;
    for (std::int64_t k = 0; k < size; ++k) {
      double product = 0, push = 0;
      for (std::int64_t e = system.row_start[b]; e < system.row_start[b + 1]; ++e) {
        const std::int64_t from = system.dof_start[system.column[e]];
        const std::int64_t columns = system.dof_start[system.column[e] + 1] - from;
        const double* const row = system.values.data + system.value_start[e] + k * columns;
        for (std::int64_t j = 0; j < columns; ++j) product += row[j] * body_velocity[from + j];
      }
      for (std::int64_t p = contacts.start[b]; p < contacts.start[b + 1]; ++p) {
        const double* const r = impulse.data + 3 * std::int64_t{contacts.contact[p]};
        const double* const j = jacobian.data + contacts.value[p] + k;
        push += j[0] * r[0] + j[size] * r[1] + j[2 * size] * r[2];
      }
      const double own = load[first + k], left = product - push - own;
      sums +=
          ResultSums{{{not_finite(body_velocity[first + k]), left * left, push * push, own * own}}};
    }
    return sums;
  }
};

}  // namespace tetwarp

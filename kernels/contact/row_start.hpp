/// @file row_start.hpp
/// Start values of the iteration over compliant bodies, from the system of a step.
#pragma once
#include <cstdint>

#include "kernels/body/row_product.hpp"

namespace tetwarp {

/// One index = one diagonal block: its inverse, stored at its first row of the system.
struct DiagonalInvertOp {
  View<const std::int32_t> first_row;
  RowInvertOp<double> invert;

  TETWARP_HD void operator()(std::int64_t i) const { invert(first_row[i]); }
};

/// One index = one row: its velocity without contact, and its metric in the acceleration of
/// velocities.
struct RowStartOp {
  View<const std::int32_t> system_row;  ///< [rows]
  SystemRows rows;
  View<const double> values, without_contact;  ///< of the system: A, [rows of the system][3]
  View<double> velocity, weight;               ///< out, [rows][3]

  TETWARP_HD void operator()(std::int64_t row) const {
    const std::int64_t place = system_row[row];
    const double* const own = values.data + 9 * std::int64_t{rows.diagonal[place]};
    for (int i = 0; i < 3; ++i) {
      velocity[3 * row + i] = without_contact[3 * place + i];
      weight[3 * row + i] = own[4 * i];
    }
  }
};

/// One index = one number: adds another vector.
struct AddNumbersOp {
  View<const double> more;
  View<double> sum;  ///< in and out

  TETWARP_HD void operator()(std::int64_t i) const { sum[i] += more[i]; }
};

}  // namespace tetwarp

/// @file compliant_gradients.hpp
/// CompliantGradients: the rows of a two-level iteration on a device as a system of conjugate
/// gradients, preconditioned by the dense matrices M^-1 of the bodies.
#pragma once
#include <cstdint>

#include "kernels/base/conjugate_gradients.hpp"
#include "kernels/contact/touching_rows.hpp"

namespace tetwarp {

/// One index = one row: A times a direction, both in frames. By lanes.
struct RowProductOp {
  using Sum = PlainSums<3>;
  static constexpr int lanes = 32;

  CompliantBodies of;
  SystemRows rows;
  View<const double> values;     ///< of the system
  View<const double> direction;  ///< [rows][3]
  View<double> product;          ///< out

  TETWARP_HD Sum part(std::int64_t row, int lane) const {
    const CompliantBody& own = of.of_row(row);
    const std::int64_t place = own.system_row + row - own.first;
    // Columns of the system are rows of the same coupling island, all of which are in the solve.
    const std::int64_t shift = own.first - std::int64_t{own.system_row};
    Sum sum;
    for (std::int64_t k = rows.start[place] + lane; k < rows.free_end[place]; k += lanes) {
      const std::int64_t column = rows.column[k] + shift;
      const double* const a = values.data + 9 * k;
      double v[3];
      of.to_world(of.of_row(column), direction.data + 3 * column, v);
      for (int i = 0; i < 3; ++i) sum.value[i] += a[i] * v[0] + a[3 + i] * v[1] + a[6 + i] * v[2];
    }
    return sum;
  }
  TETWARP_HD void finish(std::int64_t row, const Sum& sum) const {
    of.to_frame(of.of_row(row), sum.value, product.data + 3 * row);
  }
};

/// One index = one number: x += step p, r -= step q.
struct GradientMoveOp {
  const double* step;
  View<const double> p, q;
  View<double> x, r;  ///< in and out

  TETWARP_HD void operator()(std::int64_t i) const {
    x[i] += *step * p[i];
    r[i] -= *step * q[i];
  }
};

/// One index per row. Vectors are [rows][3] in frames: A there is R^T A R.
struct CompliantGradients {
  using Number = double;

  CompliantBodies of;
  SystemRows rows;
  View<const double> values;  ///< A
  View<double> x, r, z, p, q;

  TETWARP_HD static constexpr const char* label() { return "body/contact"; }
  TETWARP_HD NumberRange numbers(std::int64_t row) const { return {3 * row, 3 * row + 3}; }
};

/// for_each_by_lanes() of an executor.
template <class Exec, class Op>
TETWARP_ANY_EXEC void gradient_by_lanes(Exec& exec,
                                        const char* label,
                                        std::int64_t count,
                                        const Op& op) {
  exec.for_each_by_lanes(label, count, op);
}
/// z = M^-1 r. @param square  out: r . z
/// @pre all rows, here and below
template <class Exec>
TETWARP_ANY_EXEC void gradient_precondition(Exec& exec,
                                            const CompliantGradients& a,
                                            PlainSums<1>* square) {
  gradient_by_lanes(exec, a.label(), a.r.size / 3, ComplianceOp{a.of, a.r, a.z});
  gradient_sum(exec, a.label(), 0, a.r.size, DefectSquareOp{a.r, a.z}, square);
}
template <class Exec>
TETWARP_ANY_EXEC void gradient_start(
    Exec& exec, const CompliantGradients& a, std::int64_t, std::int64_t, PlainSums<1>* square) {
  gradient_precondition(exec, a, square);
  exec.copy(a.label(), View<const double>(a.z), a.p);
}
template <class Exec>
TETWARP_ANY_EXEC void gradient_product(
    Exec& exec, const CompliantGradients& a, std::int64_t, std::int64_t, PlainSums<1>* curvature) {
  gradient_by_lanes(exec, a.label(), a.p.size / 3, RowProductOp{a.of, a.rows, a.values, a.p, a.q});
  gradient_sum(exec, a.label(), 0, a.p.size, DefectSquareOp{a.p, a.q}, curvature);
}
template <class Exec>
TETWARP_ANY_EXEC void gradient_step(Exec& exec,
                                    const CompliantGradients& a,
                                    std::int64_t,
                                    std::int64_t,
                                    const double* step,
                                    PlainSums<1>* next) {
  exec.for_each(a.label(), a.x.size, GradientMoveOp{step, a.p, a.q, a.x, a.r});
  gradient_precondition(exec, a, next);
}

}  // namespace tetwarp

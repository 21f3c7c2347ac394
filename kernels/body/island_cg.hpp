/// @file island_cg.hpp
/// Preconditioned conjugate gradients on the rows of one coupling island, with a block Jacobi
/// preconditioner D. The same code runs on threads of the host, on one block or a grid of a device
/// in a single launch, and on a whole device stage by stage.
///
/// Conjugate gradients run with numbers of type T. Between runs the residual is computed anew in
/// float64, and the next run solves for the correction, until |r|_{D^-1} <= tolerance |b|_{D^-1},
/// or |r| is as small as the rounding of A x allows.
#pragma once
#include <cmath>
#include <cstdint>

#include "kernels/base/conjugate_gradients.hpp"
#include "kernels/base/from_index.hpp"
#include "kernels/base/plain_sums.hpp"
#include "kernels/base/view.hpp"
#include "kernels/body/row_product.hpp"

namespace tetwarp {

/// Label of the stages.
TETWARP_HD constexpr const char* gradient_label() {
  return "body/linear";
}

/// Arrays of the solves, shared by all islands; [rows][3] or [3 rows]. A system of conjugate
/// gradients, one index per row.
template <class T>
struct GradientArrays {
  using Number = T;

  SystemRows rows;
  View<const double> values;   ///< A
  View<const T> copy;          ///< A as T; for T = double the same
  DiagonalInverse<T> inverse;  ///< D^-1
  View<const double> load;     ///< b, with the columns of prescribed rows moved into it
  View<double> x;              ///< in: start; out: solution
  View<T> r, z, p, q;

  TETWARP_HD static constexpr const char* label() { return gradient_label(); }
  TETWARP_HD NumberRange numbers(std::int64_t row) const { return {3 * row, 3 * row + 3}; }
  /// Both rows of a rigid body at the first of them.
  TETWARP_HD NumberRange coupled(std::int64_t row) const {
    const int count = rows.pair[row] == 2 ? 0 : rows.pair[row] == 1 ? 6 : 3;
    return {3 * row, 3 * row + count};
  }
  TETWARP_HD double multiply(std::int64_t row) const {
    T product[3];
    multiply_blocks(copy.data, rows.column.data, rows.start[row], rows.free_end[row],
                    static_cast<const T*>(p.data), product);
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
      q[3 * row + i] = product[i];
      sum += static_cast<double>(p[3 * row + i]) * static_cast<double>(product[i]);
    }
    return sum;
  }
  TETWARP_HD void precondition(std::int64_t row) const {
    inverse.multiply(row, r.data + 3 * row, z.data + 3 * row);
  }
};

struct GradientOptions {
  double tolerance = 1e-6;
  std::int64_t max_iterations = 10000;
  bool is_watched = false;  ///< the caller may end a solve, and is asked during its iterations
};

/// How the solve of an island ended.
struct GradientEnd {
  std::int64_t iterations = 0;
  double residual = 0;  ///< relative, of the last solution
  bool is_converged = false;
  bool is_stopped = false;  ///< the host ended it
};

/// Sums and factors of the solve of an island; see GradientScalars.
struct IslandScalars {
  PlainSums<2> start;  ///< r . D^-1 r and b . D^-1 b of the float64 residual
  GradientScalars iteration;
};

/// r = b - A x, z = p = D^-1 r. Returns r . z and b . D^-1 b.
template <class T>
struct IslandStartOp {
  GradientArrays<T> a;

  TETWARP_HD void residual(std::int64_t row, T* r, T* b) const {
    double product[3];
    multiply_blocks(a.values.data, a.rows.column.data, a.rows.start[row], a.rows.free_end[row],
                    a.x.data, product);
    for (int i = 0; i < 3; ++i) {
      b[i] = static_cast<T>(a.load[3 * row + i]);
      r[i] = static_cast<T>(a.load[3 * row + i] - product[i]);
    }
  }
  TETWARP_HD PlainSums<2> operator()(std::int64_t row) const {
    T r[6], b[6], z[6], zb[6];
    if (a.rows.pair[row] == 2) return {};
    residual(row, r, b);
    if (a.rows.pair[row] == 1) residual(row + 1, r + 3, b + 3);
    const int count = a.inverse.multiply(row, r, z);
    a.inverse.multiply(row, b, zb);
    PlainSums<2> sums{};
    for (int i = 0; i < count; ++i) {
      a.r[3 * row + i] = r[i];
      a.p[3 * row + i] = z[i];
      sums.value[0] += static_cast<double>(r[i]) * static_cast<double>(z[i]);
      sums.value[1] += static_cast<double>(b[i]) * static_cast<double>(zb[i]);
    }
    return sums;
  }
};

/// Returns e . D^-1 e of e = 2^-52 (|A| |x| + |b|), by which rounding may change the residual.
template <class T>
struct GradientRoundingOp {
  GradientArrays<T> a;

  TETWARP_HD void rounding(std::int64_t row, T* e) const {
    for (int i = 0; i < 3; ++i) {
      double sum = fabs(a.load[3 * row + i]);
      for (std::int64_t k = a.rows.start[row]; k < a.rows.free_end[row]; ++k) {
        const double* const block = a.values.data + 9 * k;
        const double* const x = a.x.data + 3 * std::int64_t{a.rows.column[k]};
        for (int j = 0; j < 3; ++j) sum += fabs(block[3 * j + i] * x[j]);
      }
      e[i] = static_cast<T>(0x1p-52 * sum);
    }
  }
  TETWARP_HD PlainSums<1> operator()(std::int64_t row) const {
    T e[6], z[6];
    if (a.rows.pair[row] == 2) return {};
    rounding(row, e);
    if (a.rows.pair[row] == 1) rounding(row + 1, e + 3);
    const int count = a.inverse.multiply(row, e, z);
    PlainSums<1> sum{};
    for (int i = 0; i < count; ++i) {
      sum.value[0] += static_cast<double>(e[i]) * static_cast<double>(z[i]);
    }
    return sum;
  }
};

/// x = value.
template <class T>
struct GradientFillOp {
  GradientArrays<T> a;
  double value;

  TETWARP_HD void operator()(std::int64_t row) const {
    for (std::int64_t k = 3 * row; k < 3 * row + 3; ++k) a.x[k] = value;
  }
};

/// A single index, before the first iteration.
struct GradientBeginOp {
  IslandScalars* s;
  TETWARP_HD void operator()(std::int64_t) const {
    s->iteration.square.value[0] = s->start.value[0];
  }
};

/// Runs iterations one by one: their sums are read after each.
struct SingleIterations {
  static constexpr std::int64_t most = 1;

  template <class Exec, class Iteration>
  TETWARP_ANY_EXEC void run(Exec& exec, std::int64_t, const Iteration& iteration) const {
    iteration.run(exec);
  }
};

/// @param scalars     in memory of the executor
/// @param proceed     (std::int64_t iterations): whether to continue; called after reads of sums
/// @param iterations  runs up to `most` of them between two reads of sums
/// @pre begin and end do not separate the two rows of a rigid body
///
/// Determinism: same bits for any number of threads; sums are trees that depend only on the rows.
template <class T, class Exec, class Proceed, class Iterations = SingleIterations>
TETWARP_ANY_EXEC GradientEnd island_cg(Exec& exec,
                                       const GradientArrays<T>& a,
                                       std::int64_t begin,
                                       std::int64_t end,
                                       const GradientOptions& options,
                                       IslandScalars* scalars,
                                       const Proceed& proceed,
                                       Iterations iterations = {}) {
  constexpr int max_runs = 60;
  constexpr double run_target = sizeof(T) == sizeof(float) ? 1e-4 : 0;  // of the first residual
  GradientEnd result;
  double before = 0;
  for (int run = 0; run < max_runs; ++run) {
    gradient_sum(exec, gradient_label(), begin, end, IslandStartOp<T>{a}, &scalars->start);
    const PlainSums<2> start = exec.load(&scalars->start);
    const double square = start.value[0], unit = start.value[1];
    if (unit == 0) {  // b = 0
      exec.for_each(gradient_label(), end - begin, FromIndex<GradientFillOp<T>>{{a, 0}, begin});
      result.residual = 0;
      result.is_converged = true;
      break;
    }
    if (!(square + unit < INFINITY)) {  // b or x are beyond the range of their squares
      exec.for_each(gradient_label(), end - begin, FromIndex<GradientFillOp<T>>{{a, NAN}, begin});
      result.residual = INFINITY;
      break;
    }
    result.residual = sqrt(square / unit);
    result.is_converged = result.residual <= options.tolerance;
    if (result.is_converged || result.iterations >= options.max_iterations) break;
    if (run > 0 && !(square < 0.25 * before)) {  // no further progress
      gradient_sum(exec, gradient_label(), begin, end, GradientRoundingOp<T>{a},
                   &scalars->iteration.next);
      result.is_converged = square <= 16 * exec.load(&scalars->iteration.next).value[0];
      break;
    }
    before = square;
    const double target =
        max_of(0.5 * square_of(options.tolerance) * unit, square_of(run_target) * square);
    gradient_once(exec, gradient_label(), GradientBeginOp{scalars});
    while (result.iterations < options.max_iterations) {
      const std::int64_t count =
          min_of(Iterations::most, options.max_iterations - result.iterations);
      iterations.run(exec, count,
                     GradientIteration<GradientArrays<T>>{a, begin, end, &scalars->iteration,
                                                          &scalars->iteration.square});
      result.iterations += count;
      const GradientScalars now = exec.load(&scalars->iteration);
      if (!(now.square.value[0] > target) || now.step == 0) break;
      if (!proceed(result.iterations)) {
        result.is_stopped = true;
        return result;
      }
    }
  }
  return result;
}

}  // namespace tetwarp

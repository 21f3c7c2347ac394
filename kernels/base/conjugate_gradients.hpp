/// @file conjugate_gradients.hpp
/// Preconditioned conjugate gradients on A x = b, one iteration, for all systems and executors.
/// Source: Hestenes and Stiefel 1952.
///
/// A System holds A, the preconditioner C, and the vectors x, r = b - A x, z = C r, the direction p
/// and q = A p. Its functions take an index of its stages:
///
/// | function        |                                                                      |
/// |-----------------|----------------------------------------------------------------------|
/// | label()         | of the stages                                                        |
/// | numbers(i)      | the numbers of the vectors that belong to index i                    |
/// | multiply(i)     | sets q = A p in them; returns p . q of them                          |
/// | coupled(i)      | the numbers that C couples, at the first of their indices; else none |
/// | precondition(i) | sets z = C r in these                                                |
///
/// A system whose products take more than one stage has overloads of gradient_start(),
/// gradient_product() and gradient_step() instead of the last three.
#pragma once
#include <cstdint>

#include "kernels/base/from_index.hpp"
#include "kernels/base/plain_sums.hpp"

namespace tetwarp {

/// Numbers [begin, end) of a vector.
struct NumberRange {
  std::int64_t begin, end;
};

/// Sums and factors of an iteration, in memory of the executor. Where all threads of an executor
/// receive sums, each of them has its own.
struct GradientScalars {
  PlainSums<1> square;     ///< in: r . z before the iteration
  PlainSums<1> curvature;  ///< p . A p
  PlainSums<1> next;       ///< r . z after it
  double step;             ///< length of the step along p; zero ends a solve
  double turn;             ///< factor of p in the next direction
};

/// z = p = C r. Returns r . z.
template <class System>
struct GradientStartOp {
  System a;

  TETWARP_HD PlainSums<1> operator()(std::int64_t i) const {
    const NumberRange own = a.coupled(i);
    if (own.begin == own.end) return {};
    a.precondition(i);
    PlainSums<1> sum{};
    for (std::int64_t k = own.begin; k < own.end; ++k) {
      a.p[k] = a.z[k];
      sum.value[0] += static_cast<double>(a.r[k]) * static_cast<double>(a.z[k]);
    }
    return sum;
  }
};

/// q = A p. Returns p . q.
template <class System>
struct GradientProductOp {
  System a;

  TETWARP_HD PlainSums<1> operator()(std::int64_t i) const { return {{a.multiply(i)}}; }
};

/// x += step p, r -= step q, z = C r. Returns r . z.
template <class System>
struct GradientStepOp {
  System a;
  const double* step;

  TETWARP_HD PlainSums<1> operator()(std::int64_t i) const {
    const NumberRange own = a.coupled(i);
    if (own.begin == own.end) return {};
    const double factor = *step;
    for (std::int64_t k = own.begin; k < own.end; ++k) {
      a.x[k] += factor * static_cast<double>(a.p[k]);
      a.r[k] -= static_cast<typename System::Number>(factor) * a.q[k];
    }
    a.precondition(i);
    PlainSums<1> sum{};
    for (std::int64_t k = own.begin; k < own.end; ++k) {
      sum.value[0] += static_cast<double>(a.r[k]) * static_cast<double>(a.z[k]);
    }
    return sum;
  }
};

/// p = z + turn p.
template <class System>
struct GradientTurnOp {
  System a;
  const double* turn;

  TETWARP_HD void operator()(std::int64_t i) const {
    const auto factor = static_cast<typename System::Number>(*turn);
    const NumberRange own = a.numbers(i);
    for (std::int64_t k = own.begin; k < own.end; ++k) a.p[k] = a.z[k] + factor * a.p[k];
  }
};

/// The quotient of two sums; zero if one of them is not positive.
TETWARP_HD double gradient_quotient(const PlainSums<1>& above, const PlainSums<1>& below) {
  const double a = above.value[0], b = below.value[0];
  return a > 0 && b > 0 ? a / b : 0;
}
/// A single index: the length of the step.
struct GradientLengthOp {
  GradientScalars* s;
  TETWARP_HD void operator()(std::int64_t) const {
    s->step = gradient_quotient(s->square, s->curvature);
  }
};
/// A single index: the factor of the direction in the next one.
struct GradientMixOp {
  GradientScalars* s;
  PlainSums<1>* square;  ///< out: r . z before the next iteration; may be s->square
  TETWARP_HD void operator()(std::int64_t) const {
    s->turn = gradient_quotient(s->next, s->square);
    *square = s->next;
  }
};

/// Sums op(i) over [begin, end) into memory of the executor.
template <class Exec, class Op, class Sum>
TETWARP_ANY_EXEC void gradient_sum(
    Exec& exec, const char* label, std::int64_t begin, std::int64_t end, const Op& op, Sum* out) {
  exec.sum_to(label, begin, end, op, out);
}
/// Runs an op on the scalars.
template <class Exec, class Op>
TETWARP_ANY_EXEC void gradient_once(Exec& exec, const char* label, const Op& op) {
  exec.once(label, op);
}
/// q = A p on indices [begin, end). @param curvature  out: p . q
template <class Exec, class System>
TETWARP_ANY_EXEC void gradient_product(Exec& exec,
                                       const System& system,
                                       std::int64_t begin,
                                       std::int64_t end,
                                       PlainSums<1>* curvature) {
  gradient_sum(exec, System::label(), begin, end, GradientProductOp<System>{system}, curvature);
}

/// z = p = C r. @param square  out: r . z
template <class Exec, class System>
TETWARP_ANY_EXEC void gradient_start(
    Exec& exec, const System& system, std::int64_t begin, std::int64_t end, PlainSums<1>* square) {
  gradient_sum(exec, System::label(), begin, end, GradientStartOp<System>{system}, square);
}
/// x += step p, r -= step q, z = C r. @param next  out: r . z
template <class Exec, class System>
TETWARP_ANY_EXEC void gradient_step(Exec& exec,
                                    const System& system,
                                    std::int64_t begin,
                                    std::int64_t end,
                                    const double* step,
                                    PlainSums<1>* next) {
  gradient_sum(exec, System::label(), begin, end, GradientStepOp<System>{system, step}, next);
}

/// One iteration on indices [begin, end).
///
/// Determinism: same bits for any number of threads; sums are trees that depend only on the
/// indices.
template <class System>
struct GradientIteration {
  System system;
  std::int64_t begin, end;
  GradientScalars* scalars;
  PlainSums<1>* square;  ///< out: r . z before the next iteration; may be scalars->square

  template <class Exec>
  TETWARP_ANY_EXEC void run(Exec& exec) const {
    gradient_product(exec, system, begin, end, &scalars->curvature);
    gradient_once(exec, System::label(), GradientLengthOp{scalars});
    gradient_step(exec, system, begin, end, &scalars->step, &scalars->next);
    gradient_once(exec, System::label(), GradientMixOp{scalars, square});
    exec.for_each(System::label(), end - begin,
                  FromIndex<GradientTurnOp<System>>{{system, &scalars->turn}, begin});
  }
};

}  // namespace tetwarp

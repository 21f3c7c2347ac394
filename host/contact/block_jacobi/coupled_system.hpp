/// @file linear.hpp
/// A x = g for bodies that A couples, by conjugate gradients, for any executor: products with A and
/// no factor of it.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <tetwarp/contact_problem.hpp>

#include "host/contact/structure/structure.hpp"
#include "kernels/contact/conjugate_gradients.hpp"
#include "kernels/contact/contact_numbers.hpp"
#include "kernels/contact/vector_bodies.hpp"

namespace tetwarp {

/// How far a linear solve is, in the norm of A.
struct LinearProgress {
  double moved = 0;  ///< how far x has come
  double left = 0;   ///< at most how far it is off; estimated
};

/// What the steps of conjugate gradients tell of the error that is left, in the norm of A.
///
/// Bounded by Gauss-Radau quadrature (Golub and Meurant 1997; Meurant and Tichy 2013) from the
/// smallest eigenvalue of D^-1 A, for which half of the smallest stands that the steps of all
/// solves so far have seen (Lanczos).
class GradientError {
 public:
  void start_solve() { steps_.clear(); }
  /// @param factor  of the direction
  /// @param shrink  of g . D^-1 g
  void add_step(double factor, double shrink) { steps_.push_back({factor, shrink}); }
  std::size_t steps() const { return steps_.size(); }

  /// The square of the error in the norm of A is at most this, times g . D^-1 g.
  double left_factor();

 private:
  struct Step {
    double factor, shrink;
  };

  void find_smallest();

  std::vector<Step> steps_;  ///< of the solve at hand
  double smallest_ = 1;      ///< eigenvalue of D^-1 A known
};

/// Vectors that conjugate gradients work with, [dofs].
template <class Exec>
struct CoupledSystemMemory {
  typename Exec::template Vector<double> direction, product, image;

  // Of each step, [max_products + 1]: g . D^-1 g before it, p . A p, their quotient a, and what
  // the first has shrunk by.
  typename Exec::template Vector<PlainSums<1>> sizes, curvatures;
  typename Exec::template Vector<double> factors, shrinks;
};

/// Linear systems of one island, preconditioned by the inverse diagonal blocks of A (Hestenes and
/// Stiefel 1952). Vectors are [dofs] of the whole problem; only the island's part is touched.
template <class Exec>
class CoupledSystem {
 public:
  /// @param memory  kept by the caller
  CoupledSystem(Exec& exec,
                const ContactNumbers<double>& numbers,
                const ContactIsland& island,
                CoupledSystemMemory<Exec>& memory)
      : exec_(exec),
        island_(island),
        memory_(memory),
        matrix_(numbers.system),
        inverse_{numbers.system.dof_start, numbers.inverse_start, numbers.inverse} {
    for (auto* values : {&memory.direction, &memory.product, &memory.image}) {
      exec.resize(*values, numbers.load.size);
    }
    for (auto* values : {&memory.sizes, &memory.curvatures}) {
      exec.resize(*values, max_products + 1);
    }
    for (auto* values : {&memory.factors, &memory.shrinks}) {
      exec.resize(*values, max_products + 1);
    }
  }

  /// Moves x towards the solution until `enough`, asked now and then, or as far as rounding lets
  /// it.
  /// @param rest    in: g - A x before; out: after
  /// @param enough  (LinearProgress) -> bool
  template <class Enough>
  LinearProgress solve(View<double> x, View<double> rest, const Enough& enough) {
    constexpr std::int64_t first_ask = 4;
    double* const direction = view_of(memory_.direction).data;
    double* const product = view_of(memory_.product).data;
    double* const image = view_of(memory_.image).data;
    PlainSums<1>* const size = view_of(memory_.sizes).data;
    PlainSums<1>* const curvature = view_of(memory_.curvatures).data;
    double* const factor = view_of(memory_.factors).data;
    double* const shrink = view_of(memory_.shrinks).data;
    sum_to(GradientStartBody{inverse_, rest.data, image, direction}, size);
    LinearProgress progress;
    error_.start_solve();
    gained_ = 0;
    std::int64_t next_ask = first_ask;
    for (std::int64_t k = 0; k < max_products; ++k) {
      if (!Exec::reads_need_sync && !(size[k].value[0] > 0)) break;
      sum_to(GradientProductBody{matrix_, direction, product}, curvature + k);
      exec_.once("contact/relax", GradientQuotientBody{size + k, curvature + k, factor + k});
      sum_to(GradientStepBody{inverse_, factor + k, direction, product, x.data, rest.data, image},
             size + k + 1);
      exec_.once("contact/relax", GradientQuotientBody{size + k + 1, size + k, shrink + k});
      body_relax(exec_, island_.block_begin, island_.block_end,
                 GradientTurnBody{inverse_.dof_start, shrink + k, image, direction});
      const bool is_over = !Exec::reads_need_sync && !(size[k + 1].value[0] > 0);
      if (!is_over && k + 1 < std::min(next_ask, max_products)) continue;
      const double left = take_steps(k + 1);
      progress.moved = std::sqrt(gained_);
      if (error_.steps() == 0) break;
      progress.left = std::sqrt(left * error_.left_factor());
      if (enough(progress) || left == 0) break;
      next_ask += std::max(first_ask, next_ask / 8);
    }
    return progress;
  }

 private:
  static constexpr std::int64_t max_products = 1000;

  template <class Body>
  void sum_to(const Body& body, PlainSums<1>* out) {
    exec_.sum_to("contact/relax", island_.block_begin, island_.block_end, body, out);
  }

  /// Tells `error_` and `gained_` of the steps up to `end`.
  /// @return g . D^-1 g then; 0: nothing was left, or squares have underflowed
  double take_steps(std::int64_t end) {
    constexpr double vanishing = 1e-200;  // squares that underflow tell nothing of A
    const auto first = static_cast<std::int64_t>(error_.steps());
    const auto count = static_cast<std::size_t>(end - first);
    std::vector<PlainSums<1>> sizes(count + 1), curvatures(count);
    exec_.get(part_of(View<const PlainSums<1>>(view_of(memory_.sizes)), first, end + 1),
              sizes.data());
    exec_.get(part_of(View<const PlainSums<1>>(view_of(memory_.curvatures)), first, end),
              curvatures.data());
    for (std::size_t k = 0; k < count; ++k) {
      const double size = sizes[k].value[0], curvature = curvatures[k].value[0];
      if (!(size > 0)) return 0;
      if (!(curvature > 0)) {
        if (size < vanishing) return 0;
        throw ContactProblemError("system",
                                  ": not positive definite although its diagonal blocks are; give "
                                  "mass to every dof");
      }
      error_.add_step(size / curvature, sizes[k + 1].value[0] / size);
      gained_ += size * size / curvature;
    }
    return sizes[count].value[0];
  }

  Exec& exec_;
  const ContactIsland& island_;
  CoupledSystemMemory<Exec>& memory_;
  SystemView<double> matrix_;
  InverseBlocks inverse_;
  GradientError error_;
  double gained_ = 0;  ///< square of how far the solve at hand has come, in the norm of A
};

}  // namespace tetwarp

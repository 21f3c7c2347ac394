/// @file coupled_system.hpp
/// A x = g for bodies that A couples, by preconditioned conjugate gradients on any executor.
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

/// State of a linear solve, in the norm of A.
struct LinearProgress {
  double moved = 0;  ///< norm of the change of x since the start
  double left = 0;   ///< estimated bound of the error of x
};

/// Estimates the remaining error of a conjugate gradient solve, in the norm of A.
///
/// Gauss-Radau quadrature (Golub and Meurant 1997; Meurant and Tichy 2013) bounds the error, given
/// a lower bound of the smallest eigenvalue of D^-1 A. That lower bound is half of the smallest
/// Ritz value (Lanczos) of all solves so far: an estimate, not a proven bound.
class GradientError {
 public:
  void start_solve() { steps_.clear(); }
  /// @param factor  step length a along the direction
  /// @param shrink  ratio of g . D^-1 g after the step to that before
  void add_step(double factor, double shrink) { steps_.push_back({factor, shrink}); }
  std::size_t steps() const { return steps_.size(); }

  /// The squared error in the norm of A is at most this factor times g . D^-1 g.
  double left_factor();

 private:
  struct Step {
    double factor, shrink;
  };

  void update_smallest();

  std::vector<Step> steps_;  ///< of the current solve
  double smallest_ = 1;      ///< smallest Ritz value of D^-1 A so far
};

template <class Exec>
struct CoupledSystemMemory {
  typename Exec::template Vector<double> direction, product, image;  ///< [dofs]

  // Per step, [max_products + 1]: g . D^-1 g before it, p . A p, step length a, ratio of g . D^-1 g
  // after the step to that before.
  typename Exec::template Vector<PlainSums<1>> sizes, curvatures;
  typename Exec::template Vector<double> factors, shrinks;
};

/// Solves linear systems with A on one island, preconditioned by the inverse diagonal blocks of A
/// (Hestenes and Stiefel 1952). Vectors are [dofs] of the whole problem; only the island's part is
/// read and written.
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
      exec.make_zeros(*values, numbers.load.size);
    }
    for (auto* values : {&memory.sizes, &memory.curvatures}) {
      exec.make_zeros(*values, max_products + 1);
    }
    for (auto* values : {&memory.factors, &memory.shrinks}) {
      exec.make_zeros(*values, max_products + 1);
    }
  }

  /// Improves x until `is_enough` returns true, rounding stops the progress, or max_products steps
  /// are done.
  /// @param x          in: start; out: solution
  /// @param defect     g - A x; in: at the start; out: at the end
  /// @param is_enough  (LinearProgress) -> bool, called every few steps
  /// @throws ContactProblemError  A is not positive definite
  template <class Enough>
  LinearProgress solve(View<double> x, View<double> defect, const Enough& is_enough) {
    constexpr std::int64_t first_check = 4;
    double* const direction = view_of(memory_.direction).data;
    double* const product = view_of(memory_.product).data;
    double* const image = view_of(memory_.image).data;
    PlainSums<1>* const size = view_of(memory_.sizes).data;
    PlainSums<1>* const curvature = view_of(memory_.curvatures).data;
    double* const factor = view_of(memory_.factors).data;
    double* const shrink = view_of(memory_.shrinks).data;
    sum_to(GradientStartOp{inverse_, defect.data, image, direction}, size);
    LinearProgress progress;
    error_.start_solve();
    moved_square_ = 0;
    std::int64_t next_check = first_check;
    for (std::int64_t k = 0; k < max_products; ++k) {
      if (Exec::reads_are_free && !(size[k].value[0] > 0)) break;
      sum_to(GradientProductOp{matrix_, direction, product}, curvature + k);
      exec_.once("contact/relax", GradientQuotientOp{size + k, curvature + k, factor + k});
      sum_to(GradientStepOp{inverse_, factor + k, direction, product, x.data, defect.data, image},
             size + k + 1);
      exec_.once("contact/relax", GradientQuotientOp{size + k + 1, size + k, shrink + k});
      body_relax(exec_, island_.block_begin, island_.block_end,
                 GradientTurnOp{inverse_.dof_start, shrink + k, image, direction});
      const bool is_over = Exec::reads_are_free && !(size[k + 1].value[0] > 0);
      if (!is_over && k + 1 < std::min(next_check, max_products)) continue;
      const double left = read_steps(k + 1);
      progress.moved = std::sqrt(moved_square_);
      if (error_.steps() == 0) break;
      progress.left = std::sqrt(left * error_.left_factor());
      if (is_enough(progress) || left == 0) break;
      next_check += std::max(first_check, next_check / 8);
    }
    return progress;
  }

 private:
  static constexpr std::int64_t max_products = 1000;

  template <class Op>
  void sum_to(const Op& op, PlainSums<1>* out) {
    exec_.sum_to("contact/relax", island_.block_begin, island_.block_end, op, out);
  }

  /// Reads the steps since the last call into `error_` and `moved_square_`.
  /// @param end  steps done
  /// @return  g . D^-1 g after them; 0 if the defect is zero or its square has underflowed
  double read_steps(std::int64_t end) {
    constexpr double vanishing = 1e-200;  // below, p . A p <= 0 may be underflow
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
      moved_square_ += size * size / curvature;
    }
    return sizes[count].value[0];
  }

  Exec& exec_;
  const ContactIsland& island_;
  CoupledSystemMemory<Exec>& memory_;
  SystemView<double> matrix_;
  InverseBlocks inverse_;
  GradientError error_;
  double moved_square_ = 0;  ///< of LinearProgress::moved
};

}  // namespace tetwarp

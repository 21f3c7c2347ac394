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
#include "kernels/contact/contact_numbers.hpp"
#include "kernels/contact/coupled_gradients.hpp"
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
  /// @param shrink  ratio of r . D^-1 r after the step to that before
  void add_step(double factor, double shrink) { steps_.push_back({factor, shrink}); }
  std::size_t steps() const { return steps_.size(); }

  /// The squared error in the norm of A is at most this factor times r . D^-1 r.
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
  typename Exec::template Vector<GradientScalars> steps;             ///< [max_products + 1]
};

/// Solves linear systems with A on one island, preconditioned by the inverse diagonal blocks of A.
/// Vectors are [dofs] of the whole problem; only the island's part is read and written.
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
        system_{numbers.system, numbers.inverse_start, numbers.inverse, {}, {}, {}, {}, {}} {
    for (auto* values : {&memory.direction, &memory.product, &memory.image}) {
      exec.make_zeros(*values, numbers.load.size);
    }
    exec.make_zeros(memory.steps, max_products + 1);
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
    const std::int64_t begin = island_.block_begin, end = island_.block_end;
    GradientScalars* const steps = view_of(memory_.steps).data;
    CoupledGradients system = system_;
    system.x = x;
    system.r = defect;
    system.z = view_of(memory_.image);
    system.p = view_of(memory_.direction);
    system.q = view_of(memory_.product);
    gradient_start(exec_, system, begin, end, &steps[0].square);
    LinearProgress progress;
    error_.start_solve();
    moved_square_ = 0;
    std::int64_t next_check = first_check;
    for (std::int64_t k = 0; k < max_products; ++k) {
      if (Exec::reads_are_free && !(steps[k].square.value[0] > 0)) break;
      GradientIteration<CoupledGradients>{system, begin, end, steps + k, &steps[k + 1].square}.run(
          exec_);
      const bool is_over = Exec::reads_are_free && !(steps[k + 1].square.value[0] > 0);
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

  /// Reads the steps since the last call into `error_` and `moved_square_`.
  /// @param end  steps done
  /// @return  r . D^-1 r after them; 0 if the defect is zero or its square has underflowed
  double read_steps(std::int64_t end) {
    constexpr double vanishing = 1e-200;  // below, p . A p <= 0 may be underflow
    const auto first = static_cast<std::int64_t>(error_.steps());
    const auto count = static_cast<std::size_t>(end - first);
    std::vector<GradientScalars> steps(count + 1);
    exec_.get(part_of(View<const GradientScalars>(view_of(memory_.steps)), first, end + 1),
              steps.data());
    for (std::size_t k = 0; k < count; ++k) {
      const double size = steps[k].square.value[0], curvature = steps[k].curvature.value[0];
      if (!(size > 0)) return 0;
      if (!(curvature > 0)) {
        if (size < vanishing) return 0;
        throw ContactProblemError("system",
                                  ": not positive definite although its diagonal blocks are; give "
                                  "mass to every dof");
      }
      error_.add_step(size / curvature, steps[k + 1].square.value[0] / size);
      moved_square_ += size * size / curvature;
    }
    return steps[count].square.value[0];
  }

  Exec& exec_;
  const ContactIsland& island_;
  CoupledSystemMemory<Exec>& memory_;
  CoupledGradients system_;  ///< without vectors
  GradientError error_;
  double moved_square_ = 0;  ///< of LinearProgress::moved
};

}  // namespace tetwarp

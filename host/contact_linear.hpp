/// @file contact_linear.hpp
/// A x = g for bodies that A couples, by conjugate gradients, for any executor: products with A and
/// no factor of it.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <tetwarp/contact_problem.hpp>

#include "host/contact_structure.hpp"
#include "kernels/conjugate_gradients.hpp"
#include "kernels/contact_numbers.hpp"

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
struct LinearMemory {
  typename Exec::template Vector<double> direction, product, image;
};

/// Linear systems of one island, preconditioned by the inverse diagonal blocks of A (Hestenes and
/// Stiefel 1952). Vectors are [dofs] of the whole problem; only the island's part is touched.
template <class Exec>
class CoupledLinear {
 public:
  /// @param memory  kept by the caller
  CoupledLinear(Exec& exec,
                const ContactNumbers<double>& numbers,
                const ContactIsland& island,
                LinearMemory<Exec>& memory)
      : exec_(exec),
        island_(island),
        memory_(memory),
        matrix_(numbers.system),
        inverse_{numbers.system.dof_start, numbers.inverse_start, numbers.inverse} {
    for (auto* values : {&memory.direction, &memory.product, &memory.image}) {
      exec.resize(*values, numbers.load.size);
    }
  }

  /// Moves x towards the solution until `enough`, asked now and then, or as far as rounding lets
  /// it.
  /// @param rest    in: g - A x before; out: after
  /// @param enough  (LinearProgress) -> bool
  template <class Enough>
  LinearProgress solve(View<double> x, View<double> rest, const Enough& enough) {
    constexpr std::size_t most_products = 1000, first_ask = 4;
    constexpr double vanishing = 1e-200;  // squares that underflow tell nothing of A
    double* const direction = view_of(memory_.direction).data;
    double* const product = view_of(memory_.product).data;
    double* const image = view_of(memory_.image).data;
    double size = sum(GradientStartBody{inverse_, rest.data, image, direction});
    LinearProgress progress;
    double gained = 0;
    std::size_t next_ask = first_ask;
    error_.start_solve();
    while (size > 0 && error_.steps() < most_products) {
      const double curvature = sum(GradientProductBody{matrix_, direction, product});
      if (!(curvature > 0)) {
        if (size < vanishing) break;
        throw ContactProblemError("system",
                                  ": not positive definite although its diagonal blocks are; give "
                                  "mass to every dof");
      }
      const double last = size, factor = size / curvature;
      size = sum(GradientStepBody{inverse_, factor, direction, product, x.data, rest.data, image});
      body_relax(exec_, island_.block_begin, island_.block_end,
                 GradientTurnBody{inverse_.dof_start, size / last, image, direction});
      error_.add_step(factor, size / last);
      gained += last * factor;
      progress.moved = std::sqrt(gained);
      if (size > 0 && error_.steps() < std::min(next_ask, most_products)) continue;
      progress.left = std::sqrt(size * error_.left_factor());
      if (enough(progress)) break;
      next_ask += std::max(first_ask, next_ask / 8);
    }
    return progress;
  }

 private:
  template <class Body>
  double sum(const Body& body) {
    return exec_
        .template sum<PlainSums<1>>("contact/relax", island_.block_begin, island_.block_end, body)
        .value[0];
  }

  Exec& exec_;
  const ContactIsland& island_;
  LinearMemory<Exec>& memory_;
  SystemView<double> matrix_;
  InverseBlocks inverse_;
  GradientError error_;
};

}  // namespace tetwarp

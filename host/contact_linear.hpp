/// @file contact_linear.hpp
/// A x = g for bodies that A couples, by conjugate gradients, for any executor: products with A and
/// no factor of it.
#pragma once
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <tetwarp/contact_problem.hpp>

#include "host/contact_accelerators.hpp"
#include "host/contact_structure.hpp"
#include "host/contact_system.hpp"
#include "kernels/body_relax.hpp"

namespace tetwarp {

/// How far a linear solve is, in the norm of A.
struct LinearProgress {
  double moved = 0;  ///< how far x has come
  double left = 0;   ///< at most how far it is off; estimated
};

/// Linear systems of one island, preconditioned by the inverse diagonal blocks of A (Hestenes and
/// Stiefel 1952). Vectors are [dofs] of the whole problem; only the island's part is touched.
template <class Exec>
class CoupledLinear {
 public:
  CoupledLinear(Exec& exec,
                const ContactStructure& structure,
                const ContactSystem<double>& system,
                const ContactIsland& island)
      : exec_(exec),
        island_(island),
        matrix_(structure.system(view_of(system.system))),
        inverse_{view_of(structure.dof_start), view_of(structure.inverse_start),
                 view_of(system.inverse)},
        direction_(system.load.size()),
        product_(system.load.size()),
        image_(system.load.size()) {}

  /// Moves x towards the solution until `enough`, asked now and then, or as far as rounding lets
  /// it.
  ///
  /// What is left is bounded by Gauss-Radau quadrature (Golub and Meurant 1997; Meurant and Tichy
  /// 2013) from the smallest eigenvalue of D^-1 A, for which half of the smallest stands that the
  /// steps of all solves so far have seen (Lanczos).
  /// @param rest    in: g - A x before; out: after
  /// @param enough  (LinearProgress) -> bool
  template <class Enough>
  LinearProgress solve(std::vector<double>& x, std::vector<double>& rest, const Enough& enough) {
    constexpr std::size_t most_products = 1000, first_ask = 4;
    double size = sum(StartBody{inverse_, rest.data(), image_.data(), direction_.data()});
    LinearProgress progress;
    double gained = 0;
    std::size_t next_ask = first_ask;
    steps_.clear();
    while (size > 0 && steps_.size() < most_products) {
      const double curvature = sum(ProductBody{matrix_, direction_.data(), product_.data()});
      if (!(curvature > 0)) {
        throw ContactProblemError("system",
                                  ": not positive definite although its diagonal blocks are; give "
                                  "mass to every dof");
      }
      const double last = size, factor = size / curvature;
      size = sum(StepBody{inverse_, factor, direction_.data(), product_.data(), x.data(),
                          rest.data(), image_.data()});
      body_relax(exec_, island_.block_begin, island_.block_end,
                 TurnBody{inverse_.dof_start, size / last, image_.data(), direction_.data()});
      steps_.push_back({factor, size / last});
      gained += last * factor;
      progress.moved = std::sqrt(gained);
      if (size > 0 && steps_.size() < std::min(next_ask, most_products)) continue;
      progress.left = std::sqrt(size * left_factor());
      if (enough(progress)) break;
      next_ask += std::max(first_ask, next_ask / 8);
    }
    return progress;
  }

 private:
  /// D^-1 by blocks.
  struct InverseBlocks {
    View<const std::int64_t> dof_start;
    View<const std::int64_t> start;
    View<const double> values;

    /// z = D^-1 g and g . z of one block.
    TETWARP_HD double multiply(std::int64_t b, const double* g, double* z) const {
      const std::int64_t first = dof_start[b];
      const int size = static_cast<int>(dof_start[b + 1] - first);
      update_block(values.data + start[b], size, 0.0, 1.0, g + first, z + first);
      double product = 0;
      for (int k = 0; k < size; ++k) product += g[first + k] * z[first + k];
      return product;
    }
  };

  /// One index = one block, in all four: z = p = D^-1 g; q = A p; x += a p, g -= a q, z = D^-1 g;
  /// p = z + c p.
  struct StartBody {
    InverseBlocks inverse;
    const double* g;
    double *z, *p;
    TETWARP_HD PlainSums<1> operator()(std::int64_t b) const {
      const double product = inverse.multiply(b, g, z);
      for (std::int64_t d = inverse.dof_start[b]; d < inverse.dof_start[b + 1]; ++d) p[d] = z[d];
      return {{product}};
    }
  };
  struct ProductBody {
    SystemView<double> system;
    const double* p;
    double* q;
    TETWARP_HD PlainSums<1> operator()(std::int64_t b) const {
      multiply_block_row(system, b, p, q + system.dof_start[b]);
      double product = 0;
      for (std::int64_t d = system.dof_start[b]; d < system.dof_start[b + 1]; ++d) {
        product += p[d] * q[d];
      }
      return {{product}};
    }
  };
  struct StepBody {
    InverseBlocks inverse;
    double factor;
    const double *p, *q;
    double *x, *g, *z;
    TETWARP_HD PlainSums<1> operator()(std::int64_t b) const {
      for (std::int64_t d = inverse.dof_start[b]; d < inverse.dof_start[b + 1]; ++d) {
        x[d] += factor * p[d];
        g[d] -= factor * q[d];
      }
      return {{inverse.multiply(b, g, z)}};
    }
  };
  struct TurnBody {
    View<const std::int64_t> dof_start;
    double factor;
    const double* z;
    double* p;
    TETWARP_HD void operator()(std::int64_t b) const {
      for (std::int64_t d = dof_start[b]; d < dof_start[b + 1]; ++d) p[d] = z[d] + factor * p[d];
    }
  };

  /// One step of conjugate gradients.
  struct Step {
    double factor;  ///< of the direction
    double shrink;  ///< of g . D^-1 g
  };

  /// Lowers the smallest eigenvalue known to that of the tridiagonal matrix of the steps.
  void find_smallest() {
    const auto count = static_cast<Eigen::Index>(steps_.size());
    Eigen::VectorXd diagonal(count), beside(count);
    double carried = 0;
    for (Eigen::Index k = 0; k < count; ++k) {
      const auto [factor, shrink] = steps_[static_cast<std::size_t>(k)];
      diagonal(k) = 1 / factor + carried;
      carried = shrink / factor;
      beside(k) = std::sqrt(shrink) / factor;
    }
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
    solver.computeFromTridiagonal(diagonal, beside.head(count - 1), Eigen::EigenvaluesOnly);
    if (solver.eigenvalues()(0) > 0) smallest_ = std::min(smallest_, solver.eigenvalues()(0));
  }

  /// The square of the error in the norm of A is at most this, times g . D^-1 g.
  double left_factor() {
    find_smallest();
    const double shift = smallest_ / 2;
    double bound = 1 / shift;
    for (const Step& step : steps_) {
      const double excess = bound - step.factor;
      bound = excess / (shift * excess + step.shrink);
    }
    return bound;
  }

  template <class Body>
  double sum(const Body& body) {
    return exec_
        .template sum<PlainSums<1>>("contact/relax", island_.block_begin, island_.block_end, body)
        .value[0];
  }

  Exec& exec_;
  const ContactIsland& island_;
  SystemView<double> matrix_;
  InverseBlocks inverse_;
  std::vector<double> direction_, product_, image_;
  std::vector<Step> steps_;  ///< of the solve at hand
  double smallest_ = 1;      ///< eigenvalue of D^-1 A known
};

}  // namespace tetwarp

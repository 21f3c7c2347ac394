/// @file contact_linear.hpp
/// A x = g for bodies that A couples, by conjugate gradients, for any executor: products with A and
/// no factor of it.
#pragma once
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include <tetwarp/contact_problem.hpp>

#include "host/contact_accelerators.hpp"
#include "host/contact_structure.hpp"
#include "host/contact_system.hpp"
#include "kernels/body_relax.hpp"

namespace tetwarp {

/// When a linear solve may end; all in the norm of A but `seen`.
struct LinearAim {
  double share = 0;  ///< the error is at most this share of what x has moved,
  double error = 0;  ///< or at most this;
  double seen = std::numeric_limits<double>::infinity();  ///< in both cases also at most this, as
                                                          ///< whoever asked sees it;
  double too_far = std::numeric_limits<double>::infinity();  ///< or x has moved further than this
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

  /// Moves x towards the solution. Every step lowers the square of the error, in the norm of A, by
  /// a known gain; the gains of the last third of the steps estimate what is left (Strakos and
  /// Tichy 2002). Slow solves leave more, at most |g - A x| in D^-1 over the root of the smallest
  /// eigenvalue of D^-1 A, which the steps of all solves so far approach (Lanczos).
  /// @param rest  in: g - A x before; out: after
  /// @param see   the size, in a seminorm, of a vector [dofs]
  /// @returns the size of what x has moved, in the norm of A
  template <class See>
  double solve(const LinearAim& aim,
               std::vector<double>& x,
               std::vector<double>& rest,
               const See& see) {
    constexpr int most_products = 1000;
    double size = sum(StartBody{inverse_, rest.data(), image_.data(), direction_.data()});
    std::vector<double> gains, seen, diagonal, beside;
    double total = 0, last_share = 0;
    for (int k = 0; k < most_products && size > 0; ++k) {
      const double curvature = sum(ProductBody{matrix_, direction_.data(), product_.data()});
      if (!(curvature > 0)) {
        throw ContactProblemError("system",
                                  ": not positive definite although its diagonal blocks are; give "
                                  "mass to every dof");
      }
      const double last = size, factor = size / curvature;
      gains.push_back(size * factor);
      total += gains.back();
      seen.push_back(factor * see(direction_));
      size = sum(StepBody{inverse_, factor, direction_.data(), product_.data(), x.data(),
                          rest.data(), image_.data()});
      body_relax(exec_, island_.block_begin, island_.block_end,
                 TurnBody{inverse_.dof_start, size / last, image_.data(), direction_.data()});
      diagonal.push_back(1 / factor + last_share);
      beside.push_back(std::sqrt(size / last) / factor);
      last_share = size / last / factor;
      const double moved = std::sqrt(total);
      if (moved > aim.too_far) break;
      const int watched = std::max(4, k / 3);
      if (k < watched) continue;
      const double allowed = std::max(aim.share * moved, aim.error);
      const double left = std::sqrt(std::accumulate(gains.end() - watched, gains.end(), 0.0));
      const double seen_left = std::accumulate(seen.end() - watched, seen.end(), 0.0);
      if (left > allowed || seen_left > aim.seen) continue;
      find_smallest(diagonal, beside);
      const double bound = std::sqrt(size / smallest_);
      if (bound <= allowed && bound * seen_left <= aim.seen * left) break;
    }
    return std::sqrt(total);
  }
  double solve(const LinearAim& aim, std::vector<double>& x, std::vector<double>& rest) {
    return solve(aim, x, rest, [](const std::vector<double>&) { return 0.0; });
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

  /// Lowers the smallest eigenvalue known to that of a tridiagonal matrix.
  void find_smallest(const std::vector<double>& diagonal, const std::vector<double>& beside) {
    using Eigen::VectorXd;
    const auto size = static_cast<Eigen::Index>(diagonal.size());
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
    solver.computeFromTridiagonal(Eigen::Map<const VectorXd>(diagonal.data(), size),
                                  Eigen::Map<const VectorXd>(beside.data(), size - 1),
                                  Eigen::EigenvaluesOnly);
    if (solver.eigenvalues()(0) > 0) smallest_ = std::min(smallest_, solver.eigenvalues()(0));
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
  double smallest_ = 1;  ///< eigenvalue of D^-1 A known
};

}  // namespace tetwarp

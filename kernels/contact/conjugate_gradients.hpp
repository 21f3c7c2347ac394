/// @file conjugate_gradients.hpp
/// Stage bodies of preconditioned conjugate gradients on A x = g, one index per block of dofs; see
/// host/contact/block_jacobi/coupled_system.hpp.
#pragma once
#include <cstdint>

#include "kernels/base/plain_sums.hpp"
#include "kernels/base/view.hpp"
#include "kernels/contact/body_relax.hpp"

namespace tetwarp {

/// D^-1: the inverses of the diagonal blocks of A.
struct InverseBlocks {
  View<const std::int64_t> dof_start;
  View<const std::int64_t> start;  ///< first number of each block
  View<const double> values;

  /// Sets z = D^-1 g in one block and returns its part of g . z.
  TETWARP_HD double multiply(std::int64_t b, const double* g, double* z) const {
    const std::int64_t first = dof_start[b];
    const int size = static_cast<int>(dof_start[b + 1] - first);
    update_block(values.data + start[b], size, 0.0, 1.0, g + first, z + first);
    double product = 0;
    for (int k = 0; k < size; ++k) product += g[first + k] * z[first + k];
    return product;
  }
};

/// z = p = D^-1 g; returns g . z.
struct GradientStartOp {
  InverseBlocks inverse;
  const double* g;
  double *z, *p;
  TETWARP_HD PlainSums<1> operator()(std::int64_t b) const {
    const double product = inverse.multiply(b, g, z);
    for (std::int64_t d = inverse.dof_start[b]; d < inverse.dof_start[b + 1]; ++d) p[d] = z[d];
    return {{product}};
  }
};
/// q = A p; returns p . q.
struct GradientProductOp {
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
/// x += a p, g -= a q, z = D^-1 g; returns g . z.
struct GradientStepOp {
  InverseBlocks inverse;
  const double* a;
  const double *p, *q;
  double *x, *g, *z;
  TETWARP_HD PlainSums<1> operator()(std::int64_t b) const {
    const double factor = *a;
    for (std::int64_t d = inverse.dof_start[b]; d < inverse.dof_start[b + 1]; ++d) {
      x[d] += factor * p[d];
      g[d] -= factor * q[d];
    }
    return {{inverse.multiply(b, g, z)}};
  }
};
/// p = z + c p.
struct GradientTurnOp {
  View<const std::int64_t> dof_start;
  const double* c;
  const double* z;
  double* p;
  TETWARP_HD void operator()(std::int64_t b) const {
    const double factor = *c;
    for (std::int64_t d = dof_start[b]; d < dof_start[b + 1]; ++d) p[d] = z[d] + factor * p[d];
  }
};

/// A single index: the quotient of two numbers, or zero if one of them is not positive.
struct GradientQuotientOp {
  const PlainSums<1>*above, *below;
  double* quotient;
  TETWARP_HD void operator()(std::int64_t) const {
    const double divisor = below->value[0];
    *quotient = divisor > 0 && above->value[0] > 0 ? above->value[0] / divisor : 0;
  }
};

}  // namespace tetwarp

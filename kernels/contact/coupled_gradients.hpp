/// @file coupled_gradients.hpp
/// CoupledGradients: bodies that A couples as a system of conjugate gradients, one index per block
/// of dofs; see host/contact/block_jacobi/coupled_system.hpp.
#pragma once
#include <cstdint>

#include "kernels/base/conjugate_gradients.hpp"
#include "kernels/base/view.hpp"
#include "kernels/contact/body_relax.hpp"

namespace tetwarp {

/// Preconditioned by D^-1, the inverses of the diagonal blocks. Vectors are [dofs].
struct CoupledGradients {
  using Number = double;

  SystemView<double> system;               ///< A
  View<const std::int64_t> inverse_start;  ///< first number of each block of D^-1
  View<const double> inverse;              ///< D^-1
  View<double> x, r, z, p, q;

  TETWARP_HD static constexpr const char* label() { return "contact/relax"; }
  TETWARP_HD NumberRange numbers(std::int64_t b) const {
    return {system.dof_start[b], system.dof_start[b + 1]};
  }
  TETWARP_HD NumberRange coupled(std::int64_t b) const { return numbers(b); }
  TETWARP_HD double multiply(std::int64_t b) const {
    const NumberRange own = numbers(b);
    multiply_block_row(system, b, static_cast<const double*>(p.data), q.data + own.begin);
    double product = 0;
    for (std::int64_t d = own.begin; d < own.end; ++d) product += p[d] * q[d];
    return product;
  }
  TETWARP_HD void precondition(std::int64_t b) const {
    const NumberRange own = numbers(b);
    update_block(inverse.data + inverse_start[b], static_cast<int>(own.end - own.begin), 0.0, 1.0,
                 static_cast<const double*>(r.data) + own.begin, z.data + own.begin);
  }
};

}  // namespace tetwarp

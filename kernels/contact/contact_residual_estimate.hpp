/// @file contact_residual_estimate.hpp
/// Bodies of the residual estimator for bodies that A couples; see
/// host/contact/block_jacobi/residual_estimator.hpp.
#pragma once
#include <cstdint>

#include "kernels/base/plain_sums.hpp"
#include "kernels/base/view.hpp"
#include "kernels/contact/body_relax.hpp"
#include "kernels/contact/contact_residual.hpp"

namespace tetwarp {

/// One index = one contact: its constants with a lower bound of its block of J A^-1 J^T.
///
/// `constants` hold the blocks of omega J D^-1 J^T. A diagonal block of A^-1 is at least that of
/// D^-1, so the blocks of contacts on one block of A are divided by omega. All of A^-1 is at least
/// D^-1 over the largest eigenvalue of D^-1 A, which is below 2 / omega if the outer iteration
/// converges: hence the factor 1/2 of other contacts.
struct LowerBlocksOp {
  View<const std::int64_t> pair_start;
  View<const ContactConstants<double>> constants;
  double relaxation;
  View<ContactConstants<double>> lower;

  TETWARP_HD void operator()(std::int64_t c) const {
    const bool is_one_block = pair_start[c + 1] - pair_start[c] == 1;
    const double factor = is_one_block ? 1 / relaxation : 0.5;
    lower[c] = constants[c];
    for (double& entry : lower[c].block) entry *= factor;
    lower[c].tangent_metric *= factor;
  }
};

/// One index = one contact: sets a unit impulse along its normal.
struct UnitPushOp {
  View<double> impulse;
  TETWARP_HD void operator()(std::int64_t c) const { impulse[3 * c] = 1; }
};

/// One index = one block: |b + J^T r - A v|^2, |b|^2 and |J^T r|^2 of its dofs.
struct BalanceOp {
  BlockContacts contacts;
  View<const std::int64_t> dof_start;
  View<const double> jacobian, load, impulse, defect;

  TETWARP_HD PlainSums<3> operator()(std::int64_t b) const {
    PlainSums<3> sums;
    const std::int64_t size = dof_start[b + 1] - dof_start[b];
    for (std::int64_t k = 0; k < size; ++k) {
      double push = 0;
      for (std::int64_t p = contacts.start[b]; p < contacts.start[b + 1]; ++p) {
        const double* r = impulse.data + 3 * std::int64_t{contacts.contact[p]};
        const double* j = jacobian.data + contacts.value[p] + k;
        push += j[0] * r[0] + j[size] * r[1] + j[2 * size] * r[2];
      }
      sums.value[0] += square_of(defect[dof_start[b] + k]);
      sums.value[1] += square_of(load[dof_start[b] + k]);
      sums.value[2] += square_of(push);
    }
    return sums;
  }
};

/// One index = one contact: squared difference of two velocities in the weights of eta.
struct DistanceOp {
  View<const ContactConstants<double>> constants;
  const double *a, *b;  ///< the velocities, [contacts][3]

  TETWARP_HD PlainSums<1> operator()(std::int64_t c) const {
    const double* x = a + 3 * c;
    const double* y = b + 3 * c;
    if (!is_contact(constants[c].kind)) {
      double sum = 0;
      for (int e = 0; e < 3; ++e) sum += row_weight(constants[c], e) * square_of(x[e] - y[e]);
      return {{sum}};
    }
    return {{normal_weight(constants[c]) * square_of(x[0] - y[0]) +
             tangent_weight(constants[c]) * (square_of(x[1] - y[1]) + square_of(x[2] - y[2]))}};
  }
};

}  // namespace tetwarp

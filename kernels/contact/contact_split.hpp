/// @file contact_split.hpp
/// Stage "split" of the contact solver: solves all contacts at once from the same velocities, as if
/// the mass of each body were divided among its contacts. It needs no colors.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/contact/body_relax.hpp"
#include "kernels/contact/contact_law.hpp"
#include "kernels/contact/contact_sweep.hpp"
#include "kernels/contact/row_law.hpp"

namespace tetwarp {

/// One index = one contact between bodies: P = sum over its blocks b of n_b J A^-1 J^T, with n_b
/// the number of contacts on block b. The Delassus matrix is at most diag(P) (Cauchy-Schwarz).
template <class T>
struct BodySplitMetricOp {
  BodiesView<T> bodies;
  View<const std::int64_t> block_start;  ///< [blocks + 1], pairs by block
  View<ContactConstants<T>> constants;

  TETWARP_HD void operator()(std::int64_t c) const {
    T own[9] = {};
    for (std::int64_t p = bodies.pairs.pair_start[c]; p < bodies.pairs.pair_start[c + 1]; ++p) {
      const std::int32_t b = bodies.pairs.block[p];
      const int size = static_cast<int>(bodies.pairs.dof_start[b + 1] - bodies.pairs.dof_start[b]);
      const T share = static_cast<T>(block_start[b + 1] - block_start[b]);
      const T* j = bodies.jacobian.data + bodies.pairs.value_start[p];
      const T* own_response = bodies.response.data + bodies.pairs.value_start[p];
      for (int a = 0; a < 3; ++a) {
        for (int e = 0; e < 3; ++e) {
          for (int k = 0; k < size; ++k)
            own[3 * a + e] += share * j[a * size + k] * own_response[3 * k + e];
        }
      }
    }
    for (int e = 0; e < 9; ++e) constants[c].block[e] = own[e];
  }
};

/// One index = one contact of a Delassus matrix: P = its diagonal block plus the norms of the other
/// blocks of its row. The matrix is at most diag(P) (block diagonal dominance).
template <class T>
struct DelassusSplitMetricOp {
  DelassusView<T> delassus;
  View<ContactConstants<T>> constants;

  TETWARP_HD void operator()(std::int64_t c) const {
    T others = 0;
    for (std::int64_t k = delassus.row_start[c]; k < delassus.row_start[c + 1]; ++k) {
      if (delassus.column[k] == c) continue;
      T square = 0;
      for (int e = 0; e < 9; ++e) square += square_of(delassus.blocks[9 * k + e]);
      others += sqrt(square);
    }
    for (int e = 0; e < 9; e += 4) constants[c].block[e] += others;
  }
};

/// One index = one contact or bilateral block: solves its law for the given velocity in the metric
/// P. Rolling friction reads the impulse of its contact, which another thread may be writing, so
/// problems with rolling friction must not use this stage.
template <class T>
struct ContactSplitOp {
  View<const ContactConstants<T>> constants;
  ContactSwitches switches;
  View<const T> velocity;
  View<T> impulse;

  TETWARP_HD void operator()(std::int64_t c) const {
    T u[3] = {velocity[3 * c], velocity[3 * c + 1], velocity[3 * c + 2]};
    solve_block(constants[c], switches, u, impulse.data + 3 * c);
  }
};

}  // namespace tetwarp

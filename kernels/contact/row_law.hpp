/// @file row_law.hpp
/// The laws of blocks of three rows that are not contacts, and the choice of the law of a block.
///
/// Letters as in contact_law.hpp: r impulse, u velocity, B the block's own part of the Delassus
/// matrix.
///
/// A `bilateral` block has one to three rows with u = 0; its other rows are empty, with B = 0 and u
/// = 0. Compliance is a part of A (see host/contact/problem/row_blocks.hpp), so the laws do not
/// contain it.
///
/// A `rolling` block has the relative angular velocities of a contact about its normal, tangent 1
/// and tangent 2, and the angular impulses [N m s] against them. With r_n the normal impulse of the
/// contact:
///
///     |r_0| <= torsion max(r_n, 0),  r_0 u_0 = -torsion max(r_n, 0) |u_0|
///     |r_t| <= friction max(r_n, 0),  r_t . u_t = -friction max(r_n, 0) |u_t|,  r_t = (r_1, r_2)
///
/// In its constants `friction` is in [m], `tangent_offset[0]` is the slot of the contact less the
/// own slot, and `tangent_offset[1]` is torsion [m].
#pragma once
#include <cstdint>

#include "kernels/base/hd.hpp"
#include "kernels/contact/contact_law.hpp"

namespace tetwarp {

/// Normal impulse, at least 0, of the contact of a rolling block.
/// @param impulse  of the block; that of the contact is in the same array
template <class T>
TETWARP_HD T rolling_push(const ContactConstants<T>& c, const T* impulse) {
  return max_of(impulse[3 * static_cast<std::int64_t>(c.tangent_offset[0])], T(0));
}

/// Adds the impulses that stop all rows of a bilateral block. Rows that depend linearly on earlier
/// ones, and empty rows, keep their impulse.
/// @param velocity  u with the old impulse, [3]
template <class T>
TETWARP_HD void solve_bilateral(const ContactConstants<T>& c, const T* velocity, T* impulse) {
  constexpr T dependent = sizeof(T) == 8 ? T(1e-12) : T(1e-5);  // of a diagonal entry, remaining
  T a[9], x[3];
  bool is_used[3];
  for (int e = 0; e < 9; ++e) a[e] = c.block[e];
  for (int k = 0; k < 3; ++k) x[k] = -velocity[k];
  for (int k = 0; k < 3; ++k) {
    is_used[k] = a[4 * k] > dependent * c.block[4 * k];
    if (!is_used[k]) continue;
    for (int i = k + 1; i < 3; ++i) {
      const T factor = a[3 * i + k] / a[4 * k];
      for (int j = k; j < 3; ++j) a[3 * i + j] -= factor * a[3 * k + j];
      x[i] -= factor * x[k];
    }
  }
  for (int k = 2; k >= 0; --k) {
    for (int j = k + 1; j < 3; ++j) x[k] -= a[3 * k + j] * x[j];
    x[k] = is_used[k] ? x[k] / a[4 * k] : T(0);
    impulse[k] += x[k];
  }
}

/// Replaces the impulse of a rolling block: first torsion, then rolling in the scalar metric.
/// @param velocity  in: u with the old impulse; overwritten, [3]
template <class T>
TETWARP_HD void solve_rolling(const ContactConstants<T>& c, T* velocity, T* impulse) {
  const T* b = c.block;
  const T push = rolling_push(c, impulse);
  const T limit = c.tangent_offset[1] * push, before = impulse[0];
  const T aim = b[0] > 0 ? before - velocity[0] / b[0] : T(0);
  impulse[0] = min_of(max_of(aim, -limit), limit);
  velocity[1] += b[3] * (impulse[0] - before);
  velocity[2] += b[6] * (impulse[0] - before);
  const T metric = c.tangent_metric;
  const T x = velocity[1] - metric * impulse[1], y = velocity[2] - metric * impulse[2];
  const T speed = sqrt(square_of(x) + square_of(y));
  const T size =
      speed > 0 ? friction_size(speed, c.friction * push, T(0), metric, T(0), T(0), false) / speed
                : T(0);
  impulse[1] = -size * x;
  impulse[2] = -size * y;
}

/// Replaces the impulse of a block by the solution of its law, as solve_contact() does for a
/// contact.
/// @param impulse  r, [3], in the array of all impulses
template <class T>
TETWARP_HD void solve_block(const ContactConstants<T>& c,
                            ContactSwitches switches,
                            T* velocity,
                            T* impulse) {
  if (is_contact(c.kind)) {
    solve_contact(c, switches, velocity, impulse);
  } else if (c.kind == ContactKind::bilateral) {
    solve_bilateral(c, velocity, impulse);
  } else {
    solve_rolling(c, velocity, impulse);
  }
}

/// Weight of eta of one row, 1 / B_aa; 1 for rows that no impulse moves.
template <class T>
TETWARP_HD double row_weight(const ContactConstants<T>& c, int row) {
  return c.block[4 * row] > 0 ? 1 / double{c.block[4 * row]} : 1;
}

/// Weight of eta of the two rows of rolling, 1 / lambda_max(B_tt).
template <class T>
TETWARP_HD double rolling_weight(const ContactConstants<T>& c) {
  return c.tangent_metric > 0 ? 1 / double{c.tangent_metric} : 1;
}

/// The term of a block that is not a contact in eta^2: sum of e_a^2 / rho_a with the natural map
///
///     bilateral: e_a = rho_a u_a        rolling: e = r - P(r - rho u)
///
/// P projects torsion on its interval and rolling on its disc. Zero exactly if the law holds.
/// @param rho_0, rho_t  weights of the rows of a rolling block
template <class T>
TETWARP_HD double rolling_square(
    const ContactConstants<T>& c, double rho_0, double rho_t, const T* impulse, const T* velocity) {
  const double push = rolling_push(c, impulse);
  const double limit = double{c.tangent_offset[1]} * push, radius = double{c.friction} * push;
  const double spin = impulse[0] - rho_0 * velocity[0];
  const double e_0 = impulse[0] - min_of(max_of(spin, -limit), limit);
  double aim[2];
  for (int a = 0; a < 2; ++a) aim[a] = impulse[1 + a] - rho_t * velocity[1 + a];
  const double length = sqrt(square_of(aim[0]) + square_of(aim[1]));
  const double scale = length > radius ? radius / length : 1;
  double sum = e_0 * (e_0 / rho_0);
  for (int a = 0; a < 2; ++a) {
    const double e = impulse[1 + a] - scale * aim[a];
    sum += e * (e / rho_t);
  }
  return sum;
}

/// The same term in the weights of eta.
template <class T>
TETWARP_HD double row_eta_square(const ContactConstants<T>& c,
                                 const T* impulse,
                                 const T* velocity) {
  if (c.kind == ContactKind::rolling) {
    return rolling_square(c, row_weight(c, 0), rolling_weight(c), impulse, velocity);
  }
  double sum = 0;
  for (int a = 0; a < 3; ++a) sum += row_weight(c, a) * velocity[a] * velocity[a];
  return sum;
}

/// The same term with weights 1, for ContactSums::fclib.
template <class T>
TETWARP_HD double row_plain_square(const ContactConstants<T>& c,
                                   const T* impulse,
                                   const T* velocity) {
  if (c.kind == ContactKind::rolling) return rolling_square(c, 1, 1, impulse, velocity);
  double sum = 0;
  for (int a = 0; a < 3; ++a) sum += square_of(double{velocity[a]});
  return sum;
}

}  // namespace tetwarp

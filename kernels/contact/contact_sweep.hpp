/// @file contact_sweep.hpp
/// Stage "sweep" of the contact solver: one pass of projected Gauss-Seidel over all contacts, with
/// a Delassus matrix or through the velocities of the bodies.
#pragma once
#include <cstdint>

#include "kernels/base/from_index.hpp"
#include "kernels/base/view.hpp"
#include "kernels/contact/contact_law.hpp"
#include "kernels/contact/contact_setup.hpp"
#include "kernels/contact/row_law.hpp"

namespace tetwarp {

/// The Delassus matrix W in rows of 3x3 blocks, and the free velocities q.
template <class T>
struct DelassusView {
  View<const std::int64_t> row_start;  ///< [contacts + 1]
  View<const std::int32_t> column;     ///< [blocks]
  View<const T> blocks;                ///< [blocks][9]
  View<const T> free_velocity;         ///< q, [contacts][3]
  bool operator==(const DelassusView&) const = default;

  /// u = q + W r at contact c.
  /// @param impulse   r of all contacts, [contacts][3]
  /// @param velocity  out: u, [3]
  TETWARP_HD void velocity_at(std::int64_t c, const T* impulse, T* velocity) const {
    T x = free_velocity[3 * c], y = free_velocity[3 * c + 1], z = free_velocity[3 * c + 2];
    for (std::int64_t k = row_start[c]; k < row_start[c + 1]; ++k) {
      const T* w = blocks.data + 9 * k;
      const T* r = impulse + 3 * std::int64_t{column[k]};
      x += w[0] * r[0] + w[1] * r[1] + w[2] * r[2];
      y += w[3] * r[0] + w[4] * r[1] + w[5] * r[2];
      z += w[6] * r[0] + w[7] * r[1] + w[8] * r[2];
    }
    velocity[0] = x;
    velocity[1] = y;
    velocity[2] = z;
  }
  /// The normal component of u = q + W r at contact c.
  TETWARP_HD T normal_velocity_at(std::int64_t c, const T* impulse) const {
    T sum = free_velocity[3 * c];
    for (std::int64_t k = row_start[c]; k < row_start[c + 1]; ++k) {
      const T* w = blocks.data + 9 * k;
      const T* r = impulse + 3 * std::int64_t{column[k]};
      sum += w[0] * r[0] + w[1] * r[1] + w[2] * r[2];
    }
    return sum;
  }
};

/// The Jacobian J, the responses A^-1 J^T of the bodies, and the velocity offsets w.
template <class T>
struct BodiesView {
  PairView pairs;
  View<const T> jacobian;  ///< by pairs; see PairView
  View<const T> response;  ///< by pairs
  View<const T> offset;    ///< w, [contacts][3]
  bool operator==(const BodiesView&) const = default;

  /// u = J v + w at contact c.
  /// @param body_velocity  v, [dofs]
  /// @param velocity       out: u, [3]
  TETWARP_HD void velocity_at(std::int64_t c, const T* body_velocity, T* velocity) const {
    T sum[3] = {offset[3 * c], offset[3 * c + 1], offset[3 * c + 2]};
    for (std::int64_t p = pairs.pair_start[c]; p < pairs.pair_start[c + 1]; ++p) {
      const std::int32_t b = pairs.block[p];
      const std::int64_t first = pairs.dof_start[b];
      const int size = static_cast<int>(pairs.dof_start[b + 1] - first);
      const T* j = jacobian.data + pairs.value_start[p];
      const T* v = body_velocity + first;
      for (int k = 0; k < size; ++k) {
        sum[0] += j[k] * v[k];
        sum[1] += j[size + k] * v[k];
        sum[2] += j[2 * size + k] * v[k];
      }
    }
    for (int a = 0; a < 3; ++a) velocity[a] = sum[a];
  }
  /// The normal component of u = J v + w at contact c.
  TETWARP_HD T normal_velocity_at(std::int64_t c, const T* body_velocity) const {
    T sum = offset[3 * c];
    for (std::int64_t p = pairs.pair_start[c]; p < pairs.pair_start[c + 1]; ++p) {
      const std::int32_t b = pairs.block[p];
      const std::int64_t first = pairs.dof_start[b];
      const int size = static_cast<int>(pairs.dof_start[b + 1] - first);
      const T* j = jacobian.data + pairs.value_start[p];
      for (int k = 0; k < size; ++k) sum += j[k] * body_velocity[first + k];
    }
    return sum;
  }
  /// v += A^-1 J^T change, for a change [3] of the impulse of contact c.
  TETWARP_HD void push(std::int64_t c, const T* change, T* body_velocity) const {
    for (std::int64_t p = pairs.pair_start[c]; p < pairs.pair_start[c + 1]; ++p) {
      const std::int32_t b = pairs.block[p];
      const std::int64_t first = pairs.dof_start[b];
      const int size = static_cast<int>(pairs.dof_start[b + 1] - first);
      const T* own_response = response.data + pairs.value_start[p];
      T* v = body_velocity + first;
      for (int k = 0; k < size; ++k) {
        v[k] += own_response[3 * k] * change[0] + own_response[3 * k + 1] * change[1] +
                own_response[3 * k + 2] * change[2];
      }
    }
  }
  /// As push(), for a change of the normal impulse only.
  TETWARP_HD void push_normal(std::int64_t c, T change, T* body_velocity) const {
    for (std::int64_t p = pairs.pair_start[c]; p < pairs.pair_start[c + 1]; ++p) {
      const std::int32_t b = pairs.block[p];
      const std::int64_t first = pairs.dof_start[b];
      const int size = static_cast<int>(pairs.dof_start[b + 1] - first);
      const T* own_response = response.data + pairs.value_start[p];
      for (int k = 0; k < size; ++k) body_velocity[first + k] += own_response[3 * k] * change;
    }
  }
};

/// Freezes contacts whose impulse hardly changes: sweeps skip them except once every
/// `revisit_interval` sweeps. With empty views no contact is ever frozen.
template <class T>
struct FrozenContacts {
  /// Consecutive visits without a change that freeze a contact.
  static constexpr int visits_to_freeze = 10;
  /// Sweeps from one visit of frozen contacts to the next.
  static constexpr int revisit_interval = 8;

  View<std::uint8_t> unchanged_visits;  ///< consecutive visits without a change, [contacts]
  View<std::int32_t> skipped_visits;    ///< visits skipped so far, [contacts]
  bool all_active = true;               ///< this sweep also visits frozen contacts
  T share = 0;  ///< largest relative change of the impulse that counts as unchanged
  bool operator==(const FrozenContacts&) const = default;

  /// Whether the sweep skips contact c; counts skipped visits.
  TETWARP_HD bool skips(std::int64_t c) const {
    if (all_active || unchanged_visits[c] < visits_to_freeze) return false;
    ++skipped_visits[c];
    return true;
  }
  /// Counts a visit of contact c.
  /// @param change   of the impulse, [3]
  /// @param impulse  after it, [3]
  TETWARP_HD void note(std::int64_t c, const T* change, const T* impulse) const {
    if (unchanged_visits.size == 0) return;
    T moved = 0, size = 0;
    for (int a = 0; a < 3; ++a) {
      moved += square_of(change[a]);
      size += square_of(impulse[a]);
    }
    const bool is_unchanged = moved <= square_of(share) * size;
    unchanged_visits[c] =
        is_unchanged ? static_cast<std::uint8_t>(min_of(unchanged_visits[c] + 1, visits_to_freeze))
                     : 0;
  }
};

/// Replaces the impulse r of contact c by the solution of its law while the other impulses are
/// constant.
/// @param velocities  DelassusView or BodiesView
/// @param cause       argument of velocities.velocity_at(): all impulses, or all body velocities
/// @param r           in and out, [3]
/// @param change      out: r after minus r before, [3]
/// @return  false if the contact has a normal row only, so that change[1] and change[2] are 0
template <class Velocities, class T>
TETWARP_HD bool update_contact(const ContactConstants<T>& contact,
                               ContactSwitches switches,
                               const Velocities& velocities,
                               std::int64_t c,
                               const T* cause,
                               T* r,
                               T* change) {
  if (has_one_row(contact, r)) {
    change[0] = solve_normal(contact, velocities.normal_velocity_at(c, cause), r);
    change[1] = change[2] = 0;
    return false;
  }
  for (int a = 0; a < 3; ++a) change[a] = -r[a];
  T velocity[3];
  velocities.velocity_at(c, cause, velocity);
  solve_block(contact, switches, velocity, r);
  for (int a = 0; a < 3; ++a) change[a] += r[a];
  return true;
}

/// One index = one contact of a Delassus matrix. Contacts of one color have no block in common.
template <class T>
struct DelassusSweepOp {
  DelassusView<T> delassus;
  View<const ContactConstants<T>> constants;
  ContactSwitches switches;
  FrozenContacts<T> frozen;
  View<T> impulse;
  bool operator==(const DelassusSweepOp&) const = default;

  TETWARP_HD void operator()(std::int64_t c) const {
    if (frozen.skips(c)) return;
    T change[3];
    T* r = impulse.data + 3 * c;
    update_contact(constants[c], switches, delassus, c, impulse.data, r, change);
    frozen.note(c, change, r);
  }
};

/// One index = one contact between bodies. Contacts of one color share no body.
template <class T>
struct BodySweepOp {
  BodiesView<T> bodies;
  View<const ContactConstants<T>> constants;
  ContactSwitches switches;
  FrozenContacts<T> frozen;
  View<T> impulse;
  View<T> body_velocity;
  bool operator==(const BodySweepOp&) const = default;

  TETWARP_HD void operator()(std::int64_t c) const {
    if (frozen.skips(c)) return;
    T change[3];
    T* r = impulse.data + 3 * c;
    if (update_contact(constants[c], switches, bodies, c, body_velocity.data, r, change)) {
      bodies.push(c, change, body_velocity.data);
    } else {
      bodies.push_normal(c, change[0], body_velocity.data);
    }
    frozen.note(c, change, r);
  }
};

/// One index = one contact: its velocity u, from impulses (DelassusView) or body velocities
/// (BodiesView).
template <class Velocities, class T>
struct ContactVelocityOp {
  Velocities velocities;
  const T* cause;
  View<T> velocity;

  TETWARP_HD void operator()(std::int64_t c) const {
    velocities.velocity_at(c, cause, velocity.data + 3 * c);
  }
};

/// Velocities of contacts [first, first + count).
/// @param op  ContactVelocityOp
template <class Exec, class Op>
TETWARP_ANY_EXEC void contact_velocities(Exec& exec,
                                         std::int64_t first,
                                         std::int64_t count,
                                         const Op& op) {
  exec.for_each("contact/sweep", count, FromIndex<Op>{op, first});
}

/// Updates the impulse of every contact of an island once, color after color.
///
/// Contacts are sorted by color, so the result equals that of a serial pass in their order.
/// @param exec         where to run
/// @param color_start  first contact of each color, and the end, [colors + 1]; the caller reads it
/// @param op         DelassusSweepOp or BodySweepOp
/// @pre  contacts of one color do not influence each other; see host/contact/structure/color.hpp
///
/// Determinism: same bits for any number of threads. Cost: per contact its row of W, or J and the
/// responses of its blocks once each.
template <class Exec, class Op>
TETWARP_ANY_EXEC void contact_sweep(Exec& exec,
                                    View<const std::int64_t> color_start,
                                    const Op& op) {
  for (std::int64_t k = 0; k + 1 < color_start.size; ++k) {
    exec.for_each("contact/sweep", color_start[k + 1] - color_start[k],
                  FromIndex<Op>{op, color_start[k]});
  }
}

}  // namespace tetwarp

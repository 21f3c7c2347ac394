/// @file contact_sweep.hpp
/// Stage "sweep" of the contact solver: one contact's projected Gauss-Seidel update, in a Delassus
/// matrix or through the velocities of the bodies.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/contact/contact_law.hpp"
#include "kernels/contact/contact_setup.hpp"

namespace tetwarp {

/// W by rows of 3x3 blocks, with the free velocities.
template <class T>
struct DelassusView {
  View<const std::int64_t> row_start;  ///< [contacts + 1]
  View<const std::int32_t> column;     ///< [blocks]
  View<const T> blocks;                ///< [blocks][9]
  View<const T> free_velocity;         ///< q, [contacts][3]

  /// u = q + W r at one contact.
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
  /// Its normal component alone.
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

/// J and the responses of bodies, with the velocity offsets.
template <class T>
struct BodiesView {
  PairView pairs;
  View<const T> jacobian;
  View<const T> response;
  View<const T> offset;  ///< w, [contacts][3]

  /// u = J v + w at one contact.
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
  /// Its normal component alone.
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
  /// v += A^-1 J^T change.
  TETWARP_HD void push(std::int64_t c, const T* change, T* body_velocity) const {
    for (std::int64_t p = pairs.pair_start[c]; p < pairs.pair_start[c + 1]; ++p) {
      const std::int32_t b = pairs.block[p];
      const std::int64_t first = pairs.dof_start[b];
      const int size = static_cast<int>(pairs.dof_start[b + 1] - first);
      const T* answer = response.data + pairs.value_start[p];
      T* v = body_velocity + first;
      for (int k = 0; k < size; ++k) {
        v[k] += answer[3 * k] * change[0] + answer[3 * k + 1] * change[1] +
                answer[3 * k + 2] * change[2];
      }
    }
  }
  /// So, for a change of the normal impulse alone.
  TETWARP_HD void push_normal(std::int64_t c, T change, T* body_velocity) const {
    for (std::int64_t p = pairs.pair_start[c]; p < pairs.pair_start[c + 1]; ++p) {
      const std::int32_t b = pairs.block[p];
      const std::int64_t first = pairs.dof_start[b];
      const int size = static_cast<int>(pairs.dof_start[b + 1] - first);
      const T* answer = response.data + pairs.value_start[p];
      for (int k = 0; k < size; ++k) body_velocity[first + k] += answer[3 * k] * change;
    }
  }
};

/// Contacts that have come to rest are visited only every few sweeps. Empty views: none are.
template <class T>
struct FrozenContacts {
  static constexpr int visits_to_freeze =
      10;  ///< so many calm visits in a row, and a contact is frozen
  static constexpr int revisit_interval = 8;  ///< frozen contacts wake every so many sweeps

  View<std::uint8_t> unchanged_visits;  ///< calm visits in a row, [contacts]
  View<std::int32_t> skipped_visits;    ///< visits left out, [contacts]
  bool all_active = true;
  T share = 0;  ///< a calm visit changes the impulse by less than this share

  TETWARP_HD bool skips(std::int64_t c) const {
    if (all_active || unchanged_visits[c] < visits_to_freeze) return false;
    ++skipped_visits[c];
    return true;
  }
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

/// Replaces the impulse r of a contact by its answer to the velocity that all others leave it.
/// @param velocities  DelassusView or BodiesView, with what its velocities come from
/// @param change      out: what has been added to r, [3]
/// @return whether tangents took part; else only the normal has changed
template <class Velocities, class T>
TETWARP_HD bool answer_contact(const ContactConstants<T>& contact,
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
  solve_contact(contact, switches, velocity, r);
  for (int a = 0; a < 3; ++a) change[a] += r[a];
  return true;
}

/// One index = one contact of a Delassus matrix.
template <class T>
struct DelassusSweepBody {
  DelassusView<T> delassus;
  View<const ContactConstants<T>> constants;
  ContactSwitches switches;
  FrozenContacts<T> frozen;
  View<T> impulse;

  TETWARP_HD void operator()(std::int64_t c) const {
    if (frozen.skips(c)) return;
    T change[3];
    T* r = impulse.data + 3 * c;
    answer_contact(constants[c], switches, delassus, c, impulse.data, r, change);
    frozen.note(c, change, r);
  }
};

/// One index = one contact between bodies; contacts of one color share no body.
template <class T>
struct BodySweepBody {
  BodiesView<T> bodies;
  View<const ContactConstants<T>> constants;
  ContactSwitches switches;
  FrozenContacts<T> frozen;
  View<T> impulse;
  View<T> body_velocity;

  TETWARP_HD void operator()(std::int64_t c) const {
    if (frozen.skips(c)) return;
    T change[3];
    T* r = impulse.data + 3 * c;
    if (answer_contact(constants[c], switches, bodies, c, body_velocity.data, r, change)) {
      bodies.push(c, change, body_velocity.data);
    } else {
      bodies.push_normal(c, change[0], body_velocity.data);
    }
    frozen.note(c, change, r);
  }
};

/// One index = one contact: its velocity, from impulses (DelassusView) or bodies (BodiesView).
template <class Velocities, class T>
struct ContactVelocityBody {
  Velocities velocities;
  const T* cause;
  View<T> velocity;

  TETWARP_HD void operator()(std::int64_t c) const {
    velocities.velocity_at(c, cause, velocity.data + 3 * c);
  }
};

/// A run of contacts, shifted: index 0 is contact `first`.
template <class Body>
struct FromContact {
  Body body;
  std::int64_t first;

  TETWARP_HD void operator()(std::int64_t i) const { body(first + i); }
};

/// One pass over the contacts of an island, color after color. Contacts are sorted by color, so
/// the pass equals one in sequence.
/// @param color_start  first contact of each color, one more at the end
/// @param body         DelassusSweepBody or BodySweepBody
///
/// Determinism: same bits for any number of threads. Cost: per contact its row of W, or J and the
/// responses of its blocks once each.
template <class Exec, class Body>
TETWARP_ANY_EXEC void contact_sweep(Exec& exec,
                                    View<const std::int64_t> color_start,
                                    const Body& body) {
  for (std::int64_t k = 0; k + 1 < color_start.size; ++k) {
    exec.for_each("contact/sweep", color_start[k + 1] - color_start[k],
                  FromContact<Body>{body, color_start[k]});
  }
}

}  // namespace tetwarp

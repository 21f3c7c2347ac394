/// @file contact_numbers.hpp
/// Input and unknowns of the stages of the contact solver, as views of memory of the executor.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/contact/body_relax.hpp"
#include "kernels/contact/contact_sweep.hpp"

namespace tetwarp {

/// Contacts that influence each other, and the blocks of dofs that they move, as index ranges.
struct ContactIsland {
  std::int64_t slot_begin = 0, slot_end = 0;    ///< contacts, in the order of the structure
  std::int64_t color_begin = 0, color_end = 0;  ///< entries of color_start
  std::int64_t block_begin = 0, block_end = 0;
  std::int64_t dof_begin = 0, dof_end = 0;
  bool is_coupled = false;  ///< A couples its blocks

  TETWARP_HD std::int64_t contact_count() const { return slot_end - slot_begin; }
  TETWARP_HD std::int64_t block_count() const { return block_end - block_begin; }
  /// Number of values that its sweeps change: impulses and body velocities.
  TETWARP_HD std::int64_t value_count() const { return 3 * contact_count() + dof_end - dof_begin; }
};

/// The constant numbers of a problem: A, J, b, w in global form; W, q in local form.
template <class T>
struct ContactNumbers {
  bool is_local = false;
  View<const ContactConstants<T>> constants;  ///< [slots]
  View<const T> free_velocity;                ///< q, [3 slots]

  // Local form.
  DelassusView<T> delassus;

  // Global form.
  BodiesView<T> bodies;
  BlockContacts block_contacts;
  View<const T> body_free;  ///< A^-1 b, [dofs]; of coupled islands not set

  // Used only for islands whose blocks A couples.
  SystemView<T> system;
  View<const T> load;                       ///< b, [dofs]
  View<const std::int64_t> diagonal_value;  ///< [blocks], first number of the diagonal block of A
  View<const std::int64_t> inverse_start;   ///< [blocks + 1]
  View<const T> inverse;                    ///< D^-1: inverses of the diagonal blocks
};

/// The unknowns of a solve, for all islands together.
template <class T>
struct ContactState {
  View<T> impulse;                      ///< r, [3 slots]
  View<T> velocity;                     ///< u, [3 slots]
  View<T> body_velocity;                ///< v, [dofs]
  View<T> defect;                       ///< b + J^T r - A v, [dofs], of coupled islands
  View<std::uint8_t> unchanged_visits;  ///< of FrozenContacts, [slots]; empty: none is frozen
  View<std::int32_t> skipped_visits;    ///< as above
};

}  // namespace tetwarp

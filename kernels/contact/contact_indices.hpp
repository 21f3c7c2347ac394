/// @file contact_indices.hpp
/// The index arrays of a contact problem as views of memory of the executor; see
/// host/contact/structure/structure.hpp.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/contact/body_relax.hpp"
#include "kernels/contact/contact_setup.hpp"

namespace tetwarp {

/// A slot is a position of a contact in the order of the structure, a place is that of a dof.
/// Targets map the stored numbers of a matrix to positions in the arrays of SystemMemory.
struct ContactIndices {
  bool is_local = false;
  View<const std::int32_t> contact_of_slot;
  View<const std::int64_t> color_start;

  // Local form.
  View<const std::int64_t> delassus_row;  ///< [slots + 1]
  View<const std::int32_t> delassus_column;
  View<const std::int64_t> delassus_target;    ///< empty: W is stored by blocks in the problem
  View<const std::int64_t> delassus_diagonal;  ///< [slots]: entry of the diagonal block

  // Global form.
  PairView pairs;
  BlockContacts block_contacts;
  View<const std::int32_t> dof_of_place;      ///< dof of the problem at each place
  View<const std::uint8_t> block_is_coupled;  ///< [blocks]: 1 in an island whose blocks A couples
  View<const std::int64_t> inverse_start;     ///< [blocks + 1]
  View<const std::int64_t> diagonal_value;    ///< [blocks]: place of the diagonal block of A
  View<const std::int64_t> jacobian_target;
  View<const std::int64_t> system_row;  ///< [blocks + 1]
  View<const std::int32_t> system_column;
  View<const std::int64_t> system_value;
  View<const std::int64_t> system_target;  ///< -1: a stored zero that is left out
  std::int64_t jacobian_size = 0, system_size = 0, inverse_size = 0;
  bool has_only_nodes = false;  ///< all blocks have three dofs

  /// Whether all targets of W or A, and all targets of J, differ: then numbers are added in
  /// parallel.
  bool matrix_is_unique = true, jacobian_is_unique = true;

  std::int64_t slots() const { return contact_of_slot.size; }
  std::int64_t dofs() const { return dof_of_place.size; }
  std::int64_t blocks() const { return diagonal_value.size; }
};

}  // namespace tetwarp

/// @file structure.hpp
/// All that follows from the pattern of a contact problem alone: islands, order of contacts, blocks
/// and where each stored number goes. Kept as long as the pattern stays.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact/problem/vectors.hpp"
#include "host/contact/structure/islands.hpp"
#include "kernels/contact/contact_indices.hpp"
#include "kernels/contact/contact_numbers.hpp"

namespace tetwarp {

/// Contacts are kept in slots sorted by (island, color, index), blocks and dofs by island; the dofs
/// of blocks that no contact reaches come last, in islands without contacts.
struct ContactStructure {
  std::int64_t serial = 0;  ///< another for every structure made
  bool is_local = false;
  std::vector<std::int32_t> contact_of_slot;
  std::vector<std::int64_t> color_start;
  std::vector<ContactIsland> islands;
  std::int64_t contact_islands = 0;  ///< the first so many have contacts

  // Global form.
  std::vector<std::int32_t> dof_of_place;      ///< dof of the problem at each place here
  std::vector<std::int64_t> dof_start;         ///< [blocks + 1]
  std::vector<std::uint8_t> block_is_coupled;  ///< [blocks]: in a coupled island
  bool has_only_nodes = false;                 ///< all blocks have three dofs
  std::vector<std::int64_t> pair_start;        ///< [slots + 1]
  std::vector<std::int32_t> pair_block;
  std::vector<std::int64_t> pair_value;
  std::vector<std::int64_t> block_start;  ///< [blocks + 1]: the pairs of each block
  std::vector<std::int32_t> block_contact;
  std::vector<std::int64_t> block_value;
  std::int64_t jacobian_size = 0;
  std::vector<std::int64_t> jacobian_target;  ///< place of each stored number of J
  std::vector<std::int64_t> inverse_start;    ///< [blocks + 1]: dense diagonal blocks
  std::vector<std::int64_t> system_row;       ///< [blocks + 1]: entries of each block row of A
  std::vector<std::int32_t> system_column;
  std::vector<std::int64_t> system_value;
  std::int64_t system_size = 0;
  std::vector<std::int64_t> system_target;   ///< place of each stored number of A, -1: a zero
  std::vector<std::int64_t> diagonal_value;  ///< [blocks]: place of the diagonal block

  // Local form.
  std::vector<std::int64_t> delassus_row;  ///< [slots + 1]
  std::vector<std::int32_t> delassus_column;
  std::vector<std::int64_t> delassus_target;
  std::vector<std::int64_t> delassus_diagonal;  ///< [slots]: entry of the diagonal block

  /// No two stored numbers go to the same place: in W or A, in J.
  bool matrix_is_unique = true, jacobian_is_unique = true;

  /// As the stages read it.
  ContactIndices indices() const;
};

/// @param skip  without `converged_islands` all contacts are one island; without
///              `contactless_bodies` the blocks that no contact reaches join the first island
/// @pre check_problem(problem) has passed
ContactStructure make_structure(const ContactProblem& problem, const ContactSkipOptions& skip);
ContactStructure make_structure(const ContactProblem& problem,
                                const ContactSkipOptions& skip,
                                StructureStages& stages);

/// What a structure follows from: the index arrays of a problem, and which of the numbers of A are
/// zero, since blocks and couplings are made of the others.
struct ContactPattern {
  std::vector<std::int64_t> delassus_row;
  std::vector<std::int32_t> delassus_column;
  std::vector<std::int64_t> system_row;
  std::vector<std::int32_t> system_column;
  std::vector<std::int64_t> system_zeros;  ///< stored entries that are zero
  std::vector<std::int64_t> jacobian_row;
  std::vector<std::int32_t> jacobian_column;
  std::vector<std::int32_t> block_start;
};

ContactPattern pattern_of(const ContactProblem& problem);
bool has_pattern(const ContactProblem& problem, const ContactPattern& pattern);

}  // namespace tetwarp

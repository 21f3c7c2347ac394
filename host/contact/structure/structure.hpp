/// @file structure.hpp
/// Everything that depends only on the sparsity pattern of a contact problem: islands, order of the
/// contacts, blocks, and the target of each stored number. Reused while the pattern stays the same.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/base/index_of.hpp"
#include "host/base/vector_view.hpp"
#include "host/contact/structure/islands.hpp"
#include "kernels/contact/contact_indices.hpp"
#include "kernels/contact/contact_numbers.hpp"

namespace tetwarp {

/// Contacts are numbered by slots, sorted by (island, color, index in the problem); blocks and dofs
/// by places, sorted by island. Islands without contacts come last.
struct ContactStructure {
  std::int64_t serial = 0;  ///< different for every structure of the process
  bool is_local = false;
  std::vector<std::int32_t> contact_of_slot;
  std::vector<std::int64_t> color_start;  ///< see ContactOrder
  std::vector<ContactIsland> islands;
  std::int64_t contact_islands = 0;  ///< number of islands with contacts, which come first

  // Global form.
  std::vector<std::int32_t> dof_of_place;      ///< [dofs]: index in the problem
  std::vector<std::int64_t> dof_start;         ///< [blocks + 1]
  std::vector<std::uint8_t> block_is_coupled;  ///< [blocks]: in a coupled island
  bool has_only_nodes = false;                 ///< all blocks have three dofs
  std::vector<std::int64_t> pair_start;        ///< [slots + 1]: (contact, block) pairs of each slot
  std::vector<std::int32_t> pair_block;        ///< [pairs]
  std::vector<std::int64_t> pair_value;        ///< [pairs]: first number of J
  std::vector<std::int64_t> block_start;       ///< [blocks + 1]: the pairs of each block
  std::vector<std::int32_t> block_contact;     ///< [pairs], by block
  std::vector<std::int64_t> block_value;       ///< [pairs], by block: first number of J
  std::int64_t jacobian_size = 0;              ///< numbers of J
  std::vector<std::int64_t> jacobian_target;   ///< of each stored number of J: its index by pairs
  std::vector<std::int64_t> inverse_start;     ///< [blocks + 1]: dense diagonal blocks
  std::vector<std::int64_t> system_row;        ///< [blocks + 1]: entries of each block row of A
  std::vector<std::int32_t> system_column;     ///< [entries]: block
  std::vector<std::int64_t> system_value;      ///< [entries]: first number of A
  std::int64_t system_size = 0;                ///< numbers of A
  std::vector<std::int64_t> system_target;     ///< of each stored number of A: its index by blocks;
                                               ///< -1: a zero that is left out
  std::vector<std::int64_t> diagonal_value;    ///< [blocks]: first number of the diagonal block

  // Local form.
  std::vector<std::int64_t> delassus_row;     ///< [slots + 1]: entries of each block row of W
  std::vector<std::int32_t> delassus_column;  ///< [entries]: slot
  std::vector<std::int64_t> delassus_target;  ///< of each stored number of W: its index by blocks;
                                              ///< empty for dense blocks: the same index
  std::vector<std::int64_t> delassus_diagonal;  ///< [slots]: entry of the diagonal block

  /// No two stored numbers have the same target: in W or A, in J.
  bool matrix_is_unique = true, jacobian_is_unique = true;

  /// Views for the stages, valid while the structure is not changed.
  ContactIndices indices() const;
};

/// @param skip    without `converged_islands` all contacts are one island; without
///                `contactless_bodies` the blocks connected to no contact are in the first island
/// @param stages  runs the stages; by default one thread of the host
/// @pre check_problem(problem) has passed
ContactStructure make_structure(const ContactProblem& problem, const ContactSkipOptions& skip);
ContactStructure make_structure(const ContactProblem& problem,
                                const ContactSkipOptions& skip,
                                StructureStages& stages);

/// The structure of a local problem whose Delassus matrix has_dense_blocks().
/// @param contacts  1 or more
ContactStructure make_dense_structure(std::int64_t contacts);

/// Calls visit(number) for the stored numbers of A from which blocks and couplings follow, by
/// whether they are zero: all of them, or where the problem names its blocks those outside of the
/// blocks.
template <class Visit>
void for_each_deciding_number(const ContactProblem& problem, const Visit& visit) {
  const SparseMatrix& a = problem.system;
  std::size_t end = 0;  // block after that of the row
  for (std::size_t row = 0; row + 1 < a.row_start.size(); ++row) {
    std::int32_t first = 0, last = 0;
    if (!problem.block_start.empty()) {
      while (index_of(problem.block_start[end]) <= row) ++end;
      first = problem.block_start[end - 1], last = problem.block_start[end];
    }
    for (std::int64_t e = a.row_start[row]; e < a.row_start[row + 1]; ++e) {
      const std::int32_t column = a.column[index_of(e)];
      if (column < first || column >= last) visit(index_of(e));
    }
  }
}

/// The data of a problem that determine its structure: the index arrays, and which of the deciding
/// numbers of A are zero.
struct ContactPattern {
  std::vector<std::int64_t> delassus_row;
  std::vector<std::int32_t> delassus_column;
  std::vector<std::int64_t> system_row;
  std::vector<std::int32_t> system_column;
  std::vector<std::int64_t> system_zeros;  ///< deciding numbers that are zero
  std::vector<std::int64_t> jacobian_row;
  std::vector<std::int32_t> jacobian_column;
  std::vector<std::int32_t> block_start;
};

ContactPattern pattern_of(const ContactProblem& problem);
bool has_pattern(const ContactProblem& problem, const ContactPattern& pattern);

}  // namespace tetwarp

/// @file contact_structure.cpp
#include "host/contact_structure.hpp"

#include <utility>

#include "host/contact_structure_parts.hpp"

namespace tetwarp {

namespace {

std::vector<std::int64_t> zeros_of(const SparseMatrix& matrix) {
  std::vector<std::int64_t> zeros;
  for (std::size_t e = 0; e < matrix.value.size(); ++e) {
    if (matrix.value[e] == 0) zeros.push_back(static_cast<std::int64_t>(e));
  }
  return zeros;
}

}  // namespace

PairView ContactStructure::pairs() const {
  return {view_of(pair_start), view_of(pair_block), view_of(pair_value), view_of(dof_start)};
}

BlockContacts ContactStructure::block_contacts() const {
  return {view_of(block_start), view_of(block_contact), view_of(block_value)};
}

void take_order(ContactStructure& structure, ContactOrder order) {
  structure.contact_islands = static_cast<std::int64_t>(order.island_start.size()) - 1;
  for (std::size_t i = 0; i + 1 < order.island_start.size(); ++i) {
    ContactIsland island;
    island.slot_begin = order.island_start[i];
    island.slot_end = order.island_start[i + 1];
    island.color_begin = order.island_colors[i];
    island.color_end = order.island_colors[i + 1];
    structure.islands.push_back(island);
  }
  structure.contact_of_slot = std::move(order.contact_of_slot);
  structure.color_start = std::move(order.color_start);
}

ContactStructure make_structure(const ContactProblem& problem, const ContactSkipOptions& skip) {
  ContactStructure structure;
  structure.is_local = problem.is_local();
  if (structure.is_local) {
    fill_local_structure(problem, skip, structure);
  } else {
    fill_global_structure(problem, skip, structure);
  }
  return structure;
}

ContactPattern pattern_of(const ContactProblem& problem) {
  return {problem.delassus.row_start, problem.delassus.column,  problem.system.row_start,
          problem.system.column,      zeros_of(problem.system), problem.jacobian.row_start,
          problem.jacobian.column,    problem.block_start};
}

bool has_pattern(const ContactProblem& problem, const ContactPattern& pattern) {
  return problem.delassus.row_start == pattern.delassus_row &&
         problem.delassus.column == pattern.delassus_column &&
         problem.system.row_start == pattern.system_row &&
         problem.system.column == pattern.system_column &&
         zeros_of(problem.system) == pattern.system_zeros &&
         problem.jacobian.row_start == pattern.jacobian_row &&
         problem.jacobian.column == pattern.jacobian_column &&
         problem.block_start == pattern.block_start;
}

}  // namespace tetwarp

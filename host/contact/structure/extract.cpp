/// @file extract.cpp
/// Copies the rows, columns and arrays of an island.
#include "host/contact/structure/extract.hpp"

#include <algorithm>

#include "host/contact/problem/matrix.hpp"

namespace tetwarp {
namespace {
/// The place of each item in a part; -1 for items that are not in it.
std::vector<std::int32_t> places_in(std::int64_t count, const std::vector<std::int32_t>& part) {
  std::vector<std::int32_t> place(index_of(count), -1);
  for (std::size_t i = 0; i < part.size(); ++i) place[index_of(part[i])] = static_cast<int>(i);
  return place;
}

/// Some rows of a matrix, with renumbered columns. Drops entries (zeros) in columns without a
/// place.
SparseMatrix make_part(const SparseMatrix& matrix,
                       const std::vector<std::int32_t>& rows,
                       const std::vector<std::int32_t>& column_place,
                       std::size_t column_count) {
  SparseMatrix part{
      static_cast<std::int64_t>(rows.size()), static_cast<std::int64_t>(column_count), {0}, {}, {}};
  for (const std::int32_t row : rows) {
    for (std::int64_t e = matrix.row_start[index_of(row)]; e < matrix.row_start[index_of(row) + 1];
         ++e) {
      const std::int32_t place = column_place[index_of(matrix.column[index_of(e)])];
      if (place < 0) continue;
      part.column.push_back(place);
      part.value.push_back(matrix.value[index_of(e)]);
    }
    part.row_start.push_back(static_cast<std::int64_t>(part.column.size()));
  }
  return part;
}
/// The row blocks of some contacts, with renumbered contacts.
RowBlocks make_part(const RowBlocks& blocks, const std::int32_t* contacts, std::int64_t count) {
  RowBlocks part;
  if (blocks.empty()) return part;
  const std::vector<std::int32_t> place =
      places_in(static_cast<std::int64_t>(blocks.kind.size()), {contacts, contacts + count});
  for (std::int64_t i = 0; i < count; ++i) {
    const std::size_t c = index_of(contacts[i]);
    part.kind.push_back(blocks.kind[c]);
    part.contact.push_back(blocks.contact[c] < 0 ? -1 : place[index_of(blocks.contact[c])]);
    part.torsion.push_back(blocks.torsion[c]);
  }
  return part;
}
}  // namespace

std::vector<double> gathered(const std::vector<double>& values,
                             std::int64_t width,
                             const std::int32_t* order,
                             std::int64_t count) {
  std::vector<double> result;
  if (values.empty()) return result;
  for (std::int64_t i = 0; i < count; ++i) {
    const auto first = values.begin() + width * order[i];
    result.insert(result.end(), first, first + width);
  }
  return result;
}

ContactProblem make_island_problem(const ContactProblem& problem,
                                   const ContactStructure& structure,
                                   const ContactIsland& island) {
  const std::int32_t* contacts = structure.contact_of_slot.data() + island.slot_begin;
  const std::int64_t count = island.contact_count();
  std::vector<std::int32_t> rows;
  for (std::int64_t i = 0; i < count; ++i) {
    for (int a = 0; a < 3; ++a) rows.push_back(3 * contacts[i] + a);
  }
  const auto pick = [&](const std::vector<double>& values, std::int64_t width) {
    return gathered(values, width, contacts, count);
  };
  ContactProblem part;
  part.friction = pick(problem.friction, 1);
  part.impulse_guess = pick(problem.impulse_guess, 3);
  part.expert.row_blocks = make_part(problem.expert.row_blocks, contacts, count);
  const AdhesionState& adhesion = problem.adhesion;
  part.adhesion = {adhesion.time_step,
                   pick(adhesion.area, 1),
                   pick(adhesion.stiffness, 1),
                   pick(adhesion.tangential_stiffness, 1),
                   pick(adhesion.intensity, 1),
                   pick(adhesion.gap, 3),
                   pick(adhesion.energy, 1),
                   pick(adhesion.viscosity, 1),
                   pick(adhesion.bonding_rate, 1),
                   pick(adhesion.saturation_pressure, 1)};
  if (structure.is_local) {
    part.free_velocity = pick(problem.free_velocity, 3);
    if (has_dense_blocks(problem.delassus)) {  // the island is the whole problem, in its order
      part.delassus = make_rows(problem.delassus);
      return part;
    }
    const std::vector<std::int32_t> place = places_in(problem.delassus.columns, rows);
    part.delassus = make_part(problem.delassus, rows, place, rows.size());
    return part;
  }
  const std::vector<std::int32_t> dofs(structure.dof_of_place.begin() + island.dof_begin,
                                       structure.dof_of_place.begin() + island.dof_end);
  const std::vector<std::int32_t> place = places_in(problem.dof_count(), dofs);
  part.system = make_part(problem.system, dofs, place, dofs.size());
  part.jacobian = make_part(problem.jacobian, rows, place, dofs.size());
  part.load = gathered(problem.load, 1, dofs.data(), static_cast<std::int64_t>(dofs.size()));
  part.velocity_offset = pick(problem.velocity_offset, 3);
  for (std::int64_t b = island.block_begin; b <= island.block_end; ++b) {
    part.block_start.push_back(
        static_cast<std::int32_t>(structure.dof_start[index_of(b)] - island.dof_begin));
  }
  return part;
}

void scatter_impulses(const ContactStructure& structure,
                      const ContactIsland& island,
                      const double* from,
                      std::vector<double>& to) {
  for (std::int64_t s = island.slot_begin; s < island.slot_end; ++s, from += 3) {
    std::copy_n(from, 3, to.begin() + 3 * std::int64_t{structure.contact_of_slot[index_of(s)]});
  }
}

void scatter_velocities(const ContactStructure& structure,
                        const ContactIsland& island,
                        const double* from,
                        std::vector<double>& to) {
  for (std::int64_t d = island.dof_begin; d < island.dof_end; ++d, ++from) {
    to[index_of(structure.dof_of_place[index_of(d)])] = *from;
  }
}

void to_problem_index(const ContactStructure& structure,
                      std::int64_t first_slot,
                      ContactSums& sums) {
  if (sums.largest_contact < 0) return;
  sums.largest_contact = structure.contact_of_slot[index_of(first_slot + sums.largest_contact)];
}

}  // namespace tetwarp

/// @file indices.hpp
/// The index arrays of a structure as views, in memory of the host or of a device.
#pragma once
#include "host/contact/structure/structure.hpp"
#include "kernels/contact/contact_indices.hpp"

namespace tetwarp {

/// @param place  (const std::vector<U>&) -> View<const U>: a view of the vector or of a copy of it
template <class Place>
ContactIndices make_indices(const ContactStructure& structure, const Place& place) {
  ContactIndices indices;
  indices.is_local = structure.is_local;
  indices.contact_of_slot = place(structure.contact_of_slot);
  indices.color_start = place(structure.color_start);
  indices.delassus_row = place(structure.delassus_row);
  indices.delassus_column = place(structure.delassus_column);
  indices.delassus_target = place(structure.delassus_target);
  indices.delassus_diagonal = place(structure.delassus_diagonal);
  indices.pairs = {place(structure.pair_start), place(structure.pair_block),
                   place(structure.pair_value), place(structure.dof_start)};
  indices.block_contacts = {place(structure.block_start), place(structure.block_contact),
                            place(structure.block_value)};
  indices.dof_of_place = place(structure.dof_of_place);
  indices.block_is_coupled = place(structure.block_is_coupled);
  indices.inverse_start = place(structure.inverse_start);
  indices.diagonal_value = place(structure.diagonal_value);
  indices.jacobian_target = place(structure.jacobian_target);
  indices.system_row = place(structure.system_row);
  indices.system_column = place(structure.system_column);
  indices.system_value = place(structure.system_value);
  indices.system_target = place(structure.system_target);
  indices.jacobian_size = structure.jacobian_size;
  indices.system_size = structure.system_size;
  indices.inverse_size = structure.is_local ? 0 : structure.inverse_start.back();
  indices.has_only_nodes = structure.has_only_nodes;
  indices.matrix_is_unique = structure.matrix_is_unique;
  indices.jacobian_is_unique = structure.jacobian_is_unique;
  return indices;
}

}  // namespace tetwarp

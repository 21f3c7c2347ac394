/// @file elastic_lists.hpp
/// Index lists of a solve of contacts between compliant bodies on a device.
#pragma once
#include <cstdint>
#include <vector>

#include "kernels/body/problem_rows.hpp"
#include "kernels/elastic/contact_groups.hpp"

namespace tetwarp {

/// Contacts are in the order of groups, groups in the order of colors: no two groups of a color
/// share a body.
struct ElasticLists {
  std::vector<CompliantBody> bodies;      ///< their inverses are not set
  std::vector<std::int32_t> model_body;   ///< [bodies] of the model; -1: a rigid body
  std::vector<std::int32_t> body_of_row;  ///< [rows]
  std::vector<std::int32_t> system_row;   ///< [rows]
  std::vector<std::int32_t> model_block;  ///< [rows]
  std::vector<std::int32_t> rigid_rows;   ///< first system rows of the rigid bodies
  std::vector<std::int32_t> row_of_node;  ///< [nodes]

  std::vector<std::int32_t> contacts;  ///< their numbers in ContactRows
  std::vector<std::int32_t> block_start, block_row, block_node, block_contact;  ///< TouchingRows
  std::vector<std::int32_t> touch_start, touch;                                 ///< TouchingRows
  std::vector<double> axes;      ///< [contacts][9], as ContactRows
  std::vector<ContactArm> arms;  ///< in the order of the blocks
  std::vector<ArmPlace> places;  ///< [arms] in the jacobian

  std::vector<ContactGroup> groups;
  std::vector<std::int32_t> color_start;       ///< [colors + 1] groups of each color
  std::vector<std::int32_t> group_of_contact;  ///< [contacts]
  std::vector<std::int64_t> unit_start;        ///< [contacts + 1] places of nodes, of all contacts
  std::vector<std::int64_t> matrix_start;      ///< [contacts + 1] other contacts, the same
  std::int64_t unit_count = 0;                 ///< numbers of node velocities for unit impulses
  std::int64_t matrix_count = 0;               ///< numbers of the matrices of groups
  std::int64_t largest_group = 0;              ///< contacts
  std::int64_t sweep_operations = 0;           ///< multiplications of a sweep

  std::int64_t row_count() const { return static_cast<std::int64_t>(body_of_row.size()); }
  std::int64_t contact_count() const { return static_cast<std::int64_t>(contacts.size()); }
};

}  // namespace tetwarp

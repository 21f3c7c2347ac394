/// @file two_level_lists.hpp
/// Index lists of a solve of contacts between compliant bodies on a device.
#pragma once
#include <cstdint>
#include <vector>

#include "kernels/body/problem_rows.hpp"
#include "kernels/two_level/compliant_body.hpp"

namespace tetwarp {

struct TwoLevelLists {
  std::vector<CompliantBody> bodies;        ///< their inverses are not set
  std::vector<std::int32_t> model_body;     ///< [frames] elastic bodies, numbers of the model
  std::vector<std::int32_t> body_of_row;    ///< [rows]
  std::vector<std::int32_t> system_row;     ///< [rows]
  std::vector<std::int32_t> model_block;    ///< [rows]
  std::vector<std::int32_t> diagonal_rows;  ///< first system rows of the bodies by D^-1
  std::vector<std::int32_t> row_of_node;    ///< [nodes]
  std::vector<std::int64_t> pair_start;  ///< [nodes + 1] sums over the nodes before of the number
                                         ///< of nodes of their body
  std::int64_t compliance_size = 0;      ///< numbers

  std::vector<std::int32_t> part_start, part_block, part_body;  ///< TouchingNodes
  std::vector<std::int32_t> block_start, block_row, block_node, block_contact,
      block_part;                                ///< TouchingRows
  std::vector<std::int32_t> touch_start, touch;  ///< TouchingRows
  std::vector<double> axes;                      ///< [contacts][9], as ContactRows
  std::vector<ContactArm> arms;                  ///< in the order of the blocks
  std::vector<ArmPlace> places;                  ///< [arms] in the jacobian

  std::int64_t row_count() const { return static_cast<std::int64_t>(body_of_row.size()); }
  std::int64_t contact_count() const { return static_cast<std::int64_t>(block_start.size()) - 1; }
};

}  // namespace tetwarp

/// @file two_level_list_maker.hpp
/// Makes TwoLevelLists from coupling islands and contacts.
#pragma once
#include <cstdint>
#include <vector>

#include "host/simulate/contact/contact_islands.hpp"
#include "host/simulate/contact/contact_rows.hpp"
#include "host/simulate/contact/two_level_lists.hpp"
#include "kernels/body/system_lists.hpp"

namespace tetwarp {

/// Keeps its memory from step to step.
class TwoLevelListMaker {
 public:
  /// @param rows        of the system, in memory of the host
  /// @param body_of     [coupling islands] elastic body that gives way by its inverse, or -1
  /// @param takes       [coupling islands] which are taken
  /// @param contacts    on them; the lists are in their order
  /// @param relaxation  omega
  void make(const SystemRows& rows,
            const ContactIslands& islands,
            const std::vector<std::int32_t>& body_of,
            const ContactRows& contact_rows,
            const std::vector<std::uint8_t>& takes,
            const std::vector<std::int32_t>& contacts,
            double relaxation);
  const TwoLevelLists& lists() const { return lists_; }

 private:
  void list_bodies(const SystemRows& rows,
                   const ContactIslands& islands,
                   const std::vector<std::int32_t>& body_of,
                   const std::vector<std::uint8_t>& takes,
                   double relaxation);
  void list_nodes(const ContactRows& contact_rows, const std::vector<std::int32_t>& contacts);
  void list_blocks(const ContactRows& contact_rows, const std::vector<std::int32_t>& contacts);
  void add_block(std::int32_t row);
  void list_touching();

  TwoLevelLists lists_;
  std::vector<std::int32_t> row_of_block_;  ///< [block_count] row of the solve, or -1
  std::vector<std::int32_t> node_of_row_;   ///< [rows], or -1
};

}  // namespace tetwarp

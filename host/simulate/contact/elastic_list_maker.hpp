/// @file elastic_list_maker.hpp
/// Makes ElasticLists from coupling islands and contacts.
#pragma once
#include <cstdint>
#include <vector>

#include "host/simulate/contact/contact_islands.hpp"
#include "host/simulate/contact/contact_rows.hpp"
#include "host/simulate/cpu/rest_factors.hpp"
#include "host/simulate/elastic_lists.hpp"
#include "kernels/body/system_lists.hpp"

namespace tetwarp {

/// Keeps its memory from step to step.
class ElasticListMaker {
 public:
  /// @param rows      of the system, in memory of the host
  /// @param takes     [coupling islands] which are taken: single elastic bodies with factors,
  /// single
  ///                  rigid bodies
  /// @param contacts  on them; the lists are in their order
  void make(const SystemRows& rows,
            const ContactIslands& islands,
            const RestFactors& factors,
            const ContactRows& contact_rows,
            const std::vector<std::uint8_t>& takes,
            const std::vector<std::int32_t>& contacts);
  ElasticLists& lists() { return lists_; }

 private:
  void list_bodies(const SystemRows& rows,
                   const ContactIslands& islands,
                   const RestFactors& factors,
                   const std::vector<std::uint8_t>& takes);
  void list_nodes(const ContactRows& contact_rows, const std::vector<std::int32_t>& contacts);
  void list_blocks(const ContactRows& contact_rows, const std::vector<std::int32_t>& contacts);
  void add_block(std::int32_t row);
  void list_touching();

  ElasticLists lists_;
  std::vector<std::int32_t> row_of_block_;  ///< [block_count] row of the solve, or -1
  std::vector<std::int32_t> node_of_row_;   ///< [rows], or -1
};

}  // namespace tetwarp

/// @file elastic_list_maker.hpp
/// Makes the lists of ElasticLists from coupling islands and contacts.
#pragma once
#include <cstdint>
#include <map>
#include <utility>
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
  /// @param contacts  on them, ascending
  const ElasticLists& make(const SystemRows& rows,
                           const ContactIslands& islands,
                           const RestFactors& factors,
                           const ContactRows& contact_rows,
                           const std::vector<std::uint8_t>& takes,
                           const std::vector<std::int32_t>& contacts);
  ElasticLists& lists() { return lists_; }

 private:
  using BodyPair = std::pair<std::int32_t, std::int32_t>;

  void list_bodies(const SystemRows& rows,
                   const ContactIslands& islands,
                   const RestFactors& factors,
                   const std::vector<std::uint8_t>& takes);
  void list_groups(const ContactRows& contact_rows, const std::vector<std::int32_t>& contacts);
  std::int32_t color_of(const ContactGroup& group);
  void list_nodes(const ContactRows& contact_rows);
  void list_blocks(const ContactRows& contact_rows);
  void list_touching();
  void set_sizes();
  BodyPair bodies_of(const ContactRows& contact_rows, std::int32_t contact) const;

  ElasticLists lists_;
  std::vector<std::int32_t> row_of_block_;  ///< [block_count] row of the solve, or -1
  std::vector<std::int32_t> node_of_row_;   ///< [rows], or -1
  std::map<BodyPair, std::vector<std::int32_t>> contacts_of_;  ///< of pairs of bodies
  std::vector<std::pair<std::int32_t, const std::vector<std::int32_t>*>> colored_;
  std::vector<ContactGroup> made_;
  std::vector<std::vector<std::uint8_t>> has_color_;  ///< [bodies][colors]
};

}  // namespace tetwarp

#include "host/simulate/contact/two_level_list_maker.hpp"
#include "host/base/index_of.hpp"

#include <algorithm>

namespace tetwarp {
namespace {

std::int32_t size_of(const std::vector<std::int32_t>& list) {
  return static_cast<std::int32_t>(list.size());
}

}  // namespace

void TwoLevelListMaker::make(const SystemRows& rows,
                             const ContactIslands& islands,
                             const std::vector<std::int32_t>& body_of,
                             const ContactRows& contact_rows,
                             const std::vector<std::uint8_t>& takes,
                             const std::vector<std::int32_t>& contacts,
                             double relaxation) {
  list_bodies(rows, islands, body_of, takes, relaxation);
  list_nodes(contact_rows, contacts);
  list_blocks(contact_rows, contacts);
  list_touching();
}

/// Rows of an island follow each other, and so do the two rows of a rigid body.
void TwoLevelListMaker::list_bodies(const SystemRows& rows,
                                    const ContactIslands& islands,
                                    const std::vector<std::int32_t>& body_of,
                                    const std::vector<std::uint8_t>& takes,
                                    double relaxation) {
  for (auto* list : {&lists_.model_body, &lists_.body_of_row, &lists_.system_row,
                     &lists_.model_block, &lists_.diagonal_rows}) {
    list->clear();
  }
  lists_.bodies.clear();
  row_of_block_.assign(index_of(rows.block_of.size), -1);
  std::int32_t last = -1;
  for (std::int32_t row = 0; row < rows.unknown_count; ++row) {
    const std::int32_t block = rows.block_of[row], island = islands.of_block(block);
    if (takes[index_of(island)] == 0) continue;
    const bool is_elastic = body_of[index_of(island)] >= 0;
    if (is_elastic ? island != last : rows.pair[row] != 2) {
      CompliantBody& own = lists_.bodies.emplace_back();
      own.system_row = row;
      own.first = size_of(lists_.body_of_row);
      if (is_elastic) {
        own.frame = size_of(lists_.model_body);
        lists_.model_body.push_back(body_of[index_of(island)]);
      } else {
        own.relaxation = islands.is_coupled(island) ? relaxation : 1;
        lists_.diagonal_rows.push_back(row);
      }
    }
    last = island;
    ++lists_.bodies.back().count;
    row_of_block_[index_of(block)] = size_of(lists_.body_of_row);
    lists_.body_of_row.push_back(static_cast<std::int32_t>(lists_.bodies.size()) - 1);
    lists_.system_row.push_back(row);
    lists_.model_block.push_back(block);
  }
}

void TwoLevelListMaker::list_nodes(const ContactRows& contact_rows,
                                   const std::vector<std::int32_t>& contacts) {
  node_of_row_.assign(lists_.body_of_row.size(), -1);
  for (const std::int32_t contact : contacts) {
    for (const std::int32_t block : contact_rows.blocks_of(index_of(contact))) {
      const std::int32_t row = row_of_block_[index_of(block)];
      if (row >= 0) node_of_row_[index_of(row)] = 0;
    }
  }
  lists_.row_of_node.clear();
  lists_.pair_start.assign(1, 0);
  lists_.compliance_size = 0;
  for (CompliantBody& own : lists_.bodies) {
    own.first_node = size_of(lists_.row_of_node);
    for (std::int32_t row = own.first; row < own.first + own.count; ++row) {
      if (node_of_row_[index_of(row)] < 0) continue;
      node_of_row_[index_of(row)] = size_of(lists_.row_of_node);
      lists_.row_of_node.push_back(row);
    }
    own.node_count = size_of(lists_.row_of_node) - own.first_node;
    own.compliance = lists_.compliance_size;
    lists_.compliance_size += 9 * std::int64_t{own.node_count} * own.node_count;
    for (std::int32_t n = 0; n < own.node_count; ++n) {
      lists_.pair_start.push_back(lists_.pair_start.back() + own.node_count);
    }
  }
}

/// Appends a block of the last contact. The rows of a body follow each other, and so do its blocks.
void TwoLevelListMaker::add_block(std::int32_t row) {
  const std::int32_t body = lists_.body_of_row[index_of(row)];
  if (size_of(lists_.part_body) == lists_.part_start.back() || lists_.part_body.back() != body) {
    lists_.part_block.push_back(size_of(lists_.block_row));
    lists_.part_body.push_back(body);
    ++lists_.bodies[index_of(body)].contact_count;
  }
  lists_.block_row.push_back(row);
  lists_.block_node.push_back(node_of_row_[index_of(row)]);
  lists_.block_contact.push_back(size_of(lists_.block_start) - 1);
  lists_.block_part.push_back(size_of(lists_.part_body) - 1);
}

void TwoLevelListMaker::list_blocks(const ContactRows& contact_rows,
                                    const std::vector<std::int32_t>& contacts) {
  for (auto* list : {&lists_.block_row, &lists_.block_node, &lists_.block_contact,
                     &lists_.block_part, &lists_.part_block, &lists_.part_body}) {
    list->clear();
  }
  lists_.block_start.assign(1, 0);
  lists_.part_start.assign(1, 0);
  lists_.axes.clear();
  lists_.arms.clear();
  lists_.places.clear();
  for (const std::int32_t number : contacts) {
    const std::size_t contact = index_of(number);
    const auto axes = contact_rows.axes.begin() + static_cast<std::ptrdiff_t>(9 * contact);
    lists_.axes.insert(lists_.axes.end(), axes, axes + 9);
    const std::int32_t place = size_of(lists_.block_start) - 1;
    const std::int32_t end = contact_rows.arm_start[contact + 1];
    for (std::int32_t a = contact_rows.arm_start[contact]; a < end; ++a) {
      const std::int32_t row = row_of_block_[index_of(contact_rows.block_of_arm(a))];
      if (row < 0) continue;
      const bool is_frame = contact_rows.places[index_of(a)].angular != 0;
      lists_.arms.push_back(contact_rows.arms[index_of(a)]);
      lists_.places.push_back({place, 9 * size_of(lists_.block_row), 3, is_frame ? 9 : 0});
      add_block(row);
      if (is_frame) add_block(row + 1);
    }
    lists_.block_start.push_back(size_of(lists_.block_row));
    lists_.part_start.push_back(size_of(lists_.part_body));
  }
  lists_.part_block.push_back(size_of(lists_.block_row));
}

/// The blocks of each row.
void TwoLevelListMaker::list_touching() {
  lists_.touch_start.assign(lists_.body_of_row.size() + 1, 0);
  for (const std::int32_t row : lists_.block_row) ++lists_.touch_start[index_of(row) + 1];
  for (std::size_t row = 0; row < lists_.body_of_row.size(); ++row) {
    lists_.touch_start[row + 1] += lists_.touch_start[row];
  }
  lists_.touch.resize(lists_.block_row.size());
  // Each start is moved to the end of its list, then back.
  for (std::int32_t block = 0; block < size_of(lists_.block_row); ++block) {
    const std::size_t row = index_of(lists_.block_row[index_of(block)]);
    lists_.touch[index_of(lists_.touch_start[row]++)] = block;
  }
  std::shift_right(lists_.touch_start.begin(), lists_.touch_start.end(), 1);
  lists_.touch_start.front() = 0;
}

}  // namespace tetwarp

#include "host/simulate/contact/elastic_list_maker.hpp"
#include "host/base/index_of.hpp"

#include <algorithm>

namespace tetwarp {
namespace {

// As in sweeps on the host: bonds make impulses within a group converge slowly, and passes over
// many contacts, or over a group alone, take longer than they save.
constexpr std::int32_t group_passes = 3;
constexpr std::int64_t most_of_passes = 64;  // contacts

std::int32_t size_of(const std::vector<std::int32_t>& list) {
  return static_cast<std::int32_t>(list.size());
}

}  // namespace

const ElasticLists& ElasticListMaker::make(const SystemRows& rows,
                                           const ContactIslands& islands,
                                           const RestFactors& factors,
                                           const ContactRows& contact_rows,
                                           const std::vector<std::uint8_t>& takes,
                                           const std::vector<std::int32_t>& contacts) {
  list_bodies(rows, islands, factors, takes);
  list_groups(contact_rows, contacts);
  list_nodes(contact_rows);
  list_blocks(contact_rows);
  list_touching();
  set_sizes();
  return lists_;
}

void ElasticListMaker::list_bodies(const SystemRows& rows,
                                   const ContactIslands& islands,
                                   const RestFactors& factors,
                                   const std::vector<std::uint8_t>& takes) {
  for (auto* list : {&lists_.model_body, &lists_.body_of_row, &lists_.system_row,
                     &lists_.model_block, &lists_.rigid_rows}) {
    list->clear();
  }
  lists_.bodies.clear();
  row_of_block_.assign(index_of(rows.block_of.size), -1);
  std::int32_t last = -1;
  for (std::int32_t row = 0; row < rows.unknown_count; ++row) {
    const std::int32_t block = rows.block_of[row], island = islands.of_block(block);
    if (takes[index_of(island)] == 0) continue;
    if (island != last) {
      lists_.bodies.emplace_back();
      lists_.bodies.back().system_row = row;
      lists_.bodies.back().first = size_of(lists_.body_of_row);
      lists_.model_body.push_back(factors.body_of_island(island));
      if (lists_.model_body.back() < 0) lists_.rigid_rows.push_back(row);
      last = island;
    }
    ++lists_.bodies.back().count;
    row_of_block_[index_of(block)] = size_of(lists_.body_of_row);
    lists_.body_of_row.push_back(static_cast<std::int32_t>(lists_.bodies.size()) - 1);
    lists_.system_row.push_back(row);
    lists_.model_block.push_back(block);
  }
}

/// The bodies of the two sides of a contact, the smaller number first; -1 last: does not move.
ElasticListMaker::BodyPair ElasticListMaker::bodies_of(const ContactRows& contact_rows,
                                                       std::int32_t contact) const {
  std::int32_t first = -1, second = -1;
  for (const std::int32_t block : contact_rows.blocks_of(index_of(contact))) {
    const std::int32_t row = row_of_block_[index_of(block)];
    if (row < 0) continue;
    const std::int32_t body = lists_.body_of_row[index_of(row)];
    if (body != first) (first < 0 ? first : second) = body;
  }
  if (second >= 0 && second < first) std::swap(first, second);
  return {first, second};
}

/// The first color that no group of the same bodies has.
std::int32_t ElasticListMaker::color_of(const ContactGroup& group) {
  const auto is_taken = [&](std::size_t color) {
    return std::ranges::any_of(group.body, [&](std::int32_t body) {
      return body >= 0 && color < has_color_[index_of(body)].size() &&
             has_color_[index_of(body)][color] != 0;
    });
  };
  std::size_t color = 0;
  while (is_taken(color)) ++color;
  for (const std::int32_t body : group.body) {
    if (body < 0) continue;
    std::vector<std::uint8_t>& own = has_color_[index_of(body)];
    if (own.size() <= color) own.resize(color + 1, 0);
    own[color] = 1;
  }
  return static_cast<std::int32_t>(color);
}

/// Large groups are colored first: groups of a color run side by side, and the largest of them
/// takes longest.
void ElasticListMaker::list_groups(const ContactRows& contact_rows,
                                   const std::vector<std::int32_t>& contacts) {
  for (auto& [bodies, list] : contacts_of_) list.clear();
  for (const std::int32_t contact : contacts) {
    contacts_of_[bodies_of(contact_rows, contact)].push_back(contact);
  }
  std::erase_if(contacts_of_, [](const auto& entry) { return entry.second.empty(); });
  std::vector<std::pair<BodyPair, const std::vector<std::int32_t>*>> by_size;
  for (const auto& [bodies, list] : contacts_of_) by_size.emplace_back(bodies, &list);
  std::ranges::stable_sort(by_size, std::ranges::greater{},
                           [](const auto& entry) { return entry.second->size(); });
  has_color_.assign(lists_.bodies.size(), {});
  made_.clear();
  colored_.clear();
  for (const auto& [bodies, list] : by_size) {
    ContactGroup group;
    group.body[0] = bodies.first;
    group.body[1] = bodies.second;
    const auto size = static_cast<std::int64_t>(list->size());
    group.passes = size <= most_of_passes && contacts_of_.size() > 1 ? group_passes : 1;
    colored_.emplace_back(color_of(group), list);
    made_.push_back(group);
  }
  std::int32_t colors = 0;
  for (const auto& [color, list] : colored_) colors = std::max(colors, color + 1);
  lists_.groups.clear();
  lists_.contacts.clear();
  lists_.group_of_contact.clear();
  lists_.color_start.assign(1, 0);
  for (std::int32_t color = 0; color < colors; ++color) {
    for (std::size_t g = 0; g < made_.size(); ++g) {
      if (colored_[g].first != color) continue;
      ContactGroup& group = lists_.groups.emplace_back(made_[g]);
      const std::vector<std::int32_t>& own = *colored_[g].second;
      group.contact_begin = size_of(lists_.contacts);
      lists_.contacts.insert(lists_.contacts.end(), own.begin(), own.end());
      group.contact_end = size_of(lists_.contacts);
      lists_.group_of_contact.resize(lists_.contacts.size(),
                                     static_cast<std::int32_t>(lists_.groups.size()) - 1);
    }
    lists_.color_start.push_back(static_cast<std::int32_t>(lists_.groups.size()));
  }
}

void ElasticListMaker::list_nodes(const ContactRows& contact_rows) {
  node_of_row_.assign(lists_.body_of_row.size(), -1);
  for (const std::int32_t contact : lists_.contacts) {
    for (const std::int32_t block : contact_rows.blocks_of(index_of(contact))) {
      const std::int32_t row = row_of_block_[index_of(block)];
      if (row >= 0) node_of_row_[index_of(row)] = 0;
    }
  }
  lists_.row_of_node.clear();
  for (CompliantBody& own : lists_.bodies) {
    own.first_node = size_of(lists_.row_of_node);
    for (std::int32_t row = own.first; row < own.first + own.count; ++row) {
      if (node_of_row_[index_of(row)] < 0) continue;
      node_of_row_[index_of(row)] = size_of(lists_.row_of_node);
      lists_.row_of_node.push_back(row);
    }
    own.node_count = size_of(lists_.row_of_node) - own.first_node;
  }
}

void ElasticListMaker::list_blocks(const ContactRows& contact_rows) {
  for (auto* list : {&lists_.block_row, &lists_.block_node, &lists_.block_contact}) list->clear();
  lists_.block_start.assign(1, 0);
  lists_.axes.clear();
  lists_.arms.clear();
  lists_.places.clear();
  for (std::size_t k = 0; k < lists_.contacts.size(); ++k) {
    const std::size_t contact = index_of(lists_.contacts[k]);
    const auto axes = contact_rows.axes.begin() + static_cast<std::ptrdiff_t>(9 * contact);
    lists_.axes.insert(lists_.axes.end(), axes, axes + 9);
    const std::int32_t end = contact_rows.arm_start[contact + 1];
    for (std::int32_t a = contact_rows.arm_start[contact]; a < end; ++a) {
      const std::int32_t row = row_of_block_[index_of(contact_rows.block_of_arm(a))];
      if (row < 0) continue;
      const bool is_frame = contact_rows.places[index_of(a)].angular != 0;
      lists_.arms.push_back(contact_rows.arms[index_of(a)]);
      lists_.places.push_back(
          {static_cast<std::int32_t>(k), 9 * size_of(lists_.block_row), 3, is_frame ? 9 : 0});
      for (std::int32_t own = row; own <= row + (is_frame ? 1 : 0); ++own) {
        lists_.block_row.push_back(own);
        lists_.block_node.push_back(node_of_row_[index_of(own)]);
        lists_.block_contact.push_back(static_cast<std::int32_t>(k));
      }
    }
    lists_.block_start.push_back(size_of(lists_.block_row));
  }
}

/// The blocks of each row.
void ElasticListMaker::list_touching() {
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

void ElasticListMaker::set_sizes() {
  lists_.unit_count = lists_.matrix_count = lists_.largest_group = lists_.sweep_operations = 0;
  lists_.unit_start.assign(1, 0);
  lists_.matrix_start.assign(1, 0);
  for (ContactGroup& group : lists_.groups) {
    group.node_count = 0;
    for (const std::int32_t body : group.body) {
      if (body >= 0) group.node_count += lists_.bodies[index_of(body)].node_count;
    }
    const std::int64_t count = group.contact_count();
    group.units = lists_.unit_count;
    group.matrix = lists_.matrix_count;
    lists_.unit_count += 9 * count * group.node_count;
    lists_.matrix_count += 9 * count * count;
    lists_.sweep_operations += 9 * group.passes * count * count;
    lists_.largest_group = std::max(lists_.largest_group, count);
    for (std::int64_t k = 0; k < count; ++k) {
      lists_.unit_start.push_back(lists_.unit_start.back() + group.node_count);
      lists_.matrix_start.push_back(lists_.matrix_start.back() + count);
    }
  }
}

}  // namespace tetwarp

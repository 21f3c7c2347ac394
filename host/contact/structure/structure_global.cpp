/// @file structure_global.cpp
/// Structure of a problem given by A and J.
#include "host/contact/structure/structure_global.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "host/contact/problem/matrix.hpp"
#include "host/contact/structure/structure_parts.hpp"

namespace tetwarp {
namespace {
/// Blocks of dofs in the order of the problem, and their connections.
struct Blocks {
  std::vector<std::int64_t> start;  ///< [blocks + 1], dofs
  std::vector<std::int32_t> of_dof;
  Lists touched;  ///< of each contact: the blocks with entries in its rows of J
  Lists coupled;  ///< of each block: the blocks with nonzero entries in its rows of A

  std::int64_t count() const { return static_cast<std::int64_t>(start.size()) - 1; }
};

Blocks make_blocks(const ContactProblem& problem, std::vector<std::int64_t> starts) {
  Blocks blocks;
  blocks.start = std::move(starts);
  blocks.of_dof.resize(index_of(problem.dof_count()));
  for (std::size_t b = 0; b + 1 < blocks.start.size(); ++b) {
    std::fill(blocks.of_dof.begin() + blocks.start[b], blocks.of_dof.begin() + blocks.start[b + 1],
              static_cast<std::int32_t>(b));
  }
  const auto block_of = [&](std::int32_t dof) { return blocks.of_dof[index_of(dof)]; };
  blocks.touched = block_columns(problem.jacobian, contact_rows(problem.contact_count()),
                                 blocks.count(), block_of, true);
  blocks.coupled = block_columns(problem.system, blocks.start, blocks.count(), block_of, false);
  return blocks;
}

/// Starts of the blocks after merging adjacent blocks that A does not couple and that share a
/// contact, up to six dofs. Without it a rigid body with a diagonal mass matrix would be six
/// blocks.
std::vector<std::int64_t> merged_starts(const Blocks& blocks) {
  constexpr std::int64_t rigid_dofs = 6;
  const Lists contacts = make_transposed(blocks.touched, blocks.count());
  const auto shares_contact = [&](std::int64_t a, std::int64_t b) {
    const auto x = contacts.of(a), y = contacts.of(b);
    auto i = x.begin(), j = y.begin();
    while (i != x.end() && j != y.end() && *i != *j) *i < *j ? ++i : ++j;
    return i != x.end() && j != y.end();
  };
  std::vector<std::int64_t> starts = {0};
  for (std::int64_t b = 1; b < blocks.count(); ++b) {
    const bool fits = blocks.start[index_of(b) + 1] - starts.back() <= rigid_dofs;
    const bool is_alone = blocks.coupled.of(b).size() == 1 && blocks.coupled.of(b - 1).size() == 1;
    if (!(fits && is_alone && shares_contact(b - 1, b)))
      starts.push_back(blocks.start[index_of(b)]);
  }
  starts.push_back(blocks.start.back());
  return starts;
}

/// Sets the order of the contacts and the islands of `s`. Islands with contacts are numbered in the
/// order of their first contact; blocks connected to no contact are in the islands after them, or
/// in the first one.
/// @return the blocks, sorted by island
std::vector<std::int32_t> order_blocks(const Blocks& blocks,
                                       const ContactSkipOptions& skip,
                                       StructureStages& stages,
                                       ContactStructure& s) {
  Lists links = blocks.coupled;
  for (std::int64_t c = 0; c < blocks.touched.size(); ++c) {
    const auto touched = blocks.touched.of(c);
    links.item.insert(links.item.end(), touched.begin(), touched.end());
    links.close_list();
  }
  const std::vector<std::int32_t> component = components_of(links, blocks.count(), stages);
  std::vector<std::int32_t> island_of(index_of(blocks.count()), -1);  // by component
  std::vector<std::int32_t> contact_island;
  std::int32_t count = 0;
  for (std::int64_t c = 0; c < blocks.touched.size(); ++c) {
    std::int32_t& island = island_of[index_of(component[index_of(blocks.touched.of(c)[0])])];
    if (island < 0) island = skip.converged_islands || count == 0 ? count++ : 0;
    contact_island.push_back(island);
  }
  take_order(s, make_contact_order(blocks.touched, contact_island));
  for (const std::int32_t c : component) {
    if (island_of[index_of(c)] >= 0) continue;
    if (!skip.contactless_bodies && s.contact_islands > 0) {
      island_of[index_of(c)] = 0;
      continue;
    }
    island_of[index_of(c)] = count++;
    ContactIsland island;
    island.slot_begin = island.slot_end = blocks.touched.size();
    s.islands.push_back(island);
  }

  const auto island_of_block = [&](std::int32_t b) {
    return island_of[index_of(component[index_of(b)])];
  };
  std::vector<std::int32_t> order(index_of(blocks.count()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    return island_of_block(a) < island_of_block(b);
  });
  std::int64_t dofs = 0;
  for (std::size_t place = 0; place < order.size(); ++place) {
    const std::size_t b = index_of(order[place]);
    ContactIsland& island = s.islands[index_of(island_of_block(order[place]))];
    if (island.block_end == 0) {
      island.block_begin = static_cast<std::int64_t>(place);
      island.dof_begin = dofs;
    }
    dofs += blocks.start[b + 1] - blocks.start[b];
    island.block_end = static_cast<std::int64_t>(place) + 1;
    island.dof_end = dofs;
    island.is_coupled = island.is_coupled || blocks.coupled.of(order[place]).size() > 1;
  }
  return order;
}

/// The dofs of the blocks in their order.
void fill_dofs(const Blocks& blocks, const std::vector<std::int32_t>& order, ContactStructure& s) {
  s.dof_start = {0};
  s.inverse_start = {0};
  s.has_only_nodes = true;
  for (const std::int32_t b : order) {
    const std::int64_t first = blocks.start[index_of(b)];
    const std::int64_t last = blocks.start[index_of(b) + 1];
    s.has_only_nodes = s.has_only_nodes && last - first == 3;
    for (std::int64_t dof = first; dof < last; ++dof) {
      s.dof_of_place.push_back(static_cast<std::int32_t>(dof));
    }
    s.dof_start.push_back(s.dof_start.back() + last - first);
    s.inverse_start.push_back(s.inverse_start.back() + (last - first) * (last - first));
  }
}

/// The blocks of each contact, sorted, and the targets of the numbers of J.
void fill_pairs(const ContactProblem& problem,
                const Blocks& blocks,
                const std::vector<std::int32_t>& place_of_block,
                ContactStructure& s) {
  s.pair_start = {0};
  s.jacobian_target.resize(problem.jacobian.value.size());
  std::vector<std::int32_t> touched;
  for (const std::int32_t contact : s.contact_of_slot) {
    touched.clear();
    for (const std::int32_t b : blocks.touched.of(contact)) {
      touched.push_back(place_of_block[index_of(b)]);
    }
    std::sort(touched.begin(), touched.end());
    const auto first = static_cast<std::int64_t>(s.pair_block.size());
    for (const std::int32_t b : touched) {
      s.pair_block.push_back(b);
      s.pair_value.push_back(s.jacobian_size);
      s.jacobian_size += 3 * (s.dof_start[index_of(b) + 1] - s.dof_start[index_of(b)]);
    }
    s.pair_start.push_back(static_cast<std::int64_t>(s.pair_block.size()));
    for (std::int64_t a = 0; a < 3; ++a) {
      const std::int64_t row = 3 * std::int64_t{contact} + a;
      const std::int64_t last = problem.jacobian.row_start[index_of(row + 1)];
      for (std::int64_t e = problem.jacobian.row_start[index_of(row)]; e < last; ++e) {
        const std::int32_t dof = problem.jacobian.column[index_of(e)];
        const std::int32_t b = blocks.of_dof[index_of(dof)];
        const std::int32_t place = place_of_block[index_of(b)];
        const auto pair =
            first + (std::lower_bound(touched.begin(), touched.end(), place) - touched.begin());
        const std::int64_t size = s.dof_start[index_of(place) + 1] - s.dof_start[index_of(place)];
        s.jacobian_target[index_of(e)] =
            s.pair_value[index_of(pair)] + a * size + dof - blocks.start[index_of(b)];
      }
    }
  }
}

/// The pairs of fill_pairs(), sorted by block.
void fill_block_pairs(std::int64_t block_count, ContactStructure& s) {
  Lists pairs;
  pairs.start = s.pair_start;
  pairs.item = s.pair_block;
  const Lists by_block = make_transposed(pairs, block_count);
  s.block_start = by_block.start;
  s.block_contact = by_block.item;
  s.block_value.resize(s.block_contact.size());
  std::vector<std::int64_t> next(s.block_start.begin(), s.block_start.end() - 1);
  for (std::size_t p = 0; p < s.pair_block.size(); ++p) {
    s.block_value[index_of(next[index_of(s.pair_block[p])]++)] = s.pair_value[p];
  }
}

/// The blocks of A, and the targets of its numbers.
void fill_system(const ContactProblem& problem,
                 const Blocks& blocks,
                 const std::vector<std::int32_t>& order,
                 const std::vector<std::int32_t>& place_of_block,
                 ContactStructure& s) {
  const SparseMatrix& a = problem.system;
  const auto size_of = [&](std::int32_t place) {
    return s.dof_start[index_of(place) + 1] - s.dof_start[index_of(place)];
  };
  s.system_row = {0};
  s.system_target.resize(a.value.size());
  std::vector<std::int32_t> columns;
  std::vector<std::int64_t> entry_of(order.size(), -1);  // of the current block row, by block
  for (std::size_t place = 0; place < order.size(); ++place) {
    const std::size_t b = index_of(order[place]);
    columns.clear();
    for (const std::int32_t other : blocks.coupled.of(order[place])) {
      columns.push_back(place_of_block[index_of(other)]);
    }
    std::sort(columns.begin(), columns.end());
    const std::int64_t rows = blocks.start[b + 1] - blocks.start[b];
    for (const std::int32_t column : columns) {
      entry_of[index_of(order[index_of(column)])] = s.system_size;
      if (column == static_cast<std::int32_t>(place)) s.diagonal_value.push_back(s.system_size);
      s.system_column.push_back(column);
      s.system_value.push_back(s.system_size);
      s.system_size += rows * size_of(column);
    }
    s.system_row.push_back(static_cast<std::int64_t>(s.system_column.size()));
    for (std::int64_t e = a.row_start[index_of(blocks.start[b])], row = blocks.start[b];
         row < blocks.start[b + 1]; ++row) {
      for (; e < a.row_start[index_of(row) + 1]; ++e) {
        const std::int32_t dof = a.column[index_of(e)];
        const std::int32_t other = blocks.of_dof[index_of(dof)];
        const std::int64_t begin = blocks.start[index_of(other)];
        const std::int64_t size = blocks.start[index_of(other) + 1] - begin;
        const std::int64_t entry = entry_of[index_of(other)];
        s.system_target[index_of(e)] =
            entry < 0 ? -1 : entry + (row - blocks.start[b]) * size + dof - begin;
      }
    }
    for (const std::int32_t other : blocks.coupled.of(order[place])) entry_of[index_of(other)] = -1;
  }
}
}  // namespace

void fill_global_structure(const ContactProblem& problem,
                           const ContactSkipOptions& skip,
                           StructureStages& stages,
                           ContactStructure& structure) {
  const std::vector<std::int32_t> starts = blocks_of(problem);
  Blocks blocks = make_blocks(problem, {starts.begin(), starts.end()});
  if (problem.block_start.empty()) {
    std::vector<std::int64_t> merged = merged_starts(blocks);
    if (merged.size() != blocks.start.size()) blocks = make_blocks(problem, std::move(merged));
  }
  const std::vector<std::int32_t> order = order_blocks(blocks, skip, stages, structure);
  const std::vector<std::int32_t> place_of_block = places_of(order);
  fill_dofs(blocks, order, structure);
  for (const ContactIsland& island : structure.islands) {
    structure.block_is_coupled.insert(structure.block_is_coupled.end(),
                                      index_of(island.block_count()), island.is_coupled);
  }
  fill_pairs(problem, blocks, place_of_block, structure);
  fill_block_pairs(blocks.count(), structure);
  fill_system(problem, blocks, order, place_of_block, structure);
}

}  // namespace tetwarp

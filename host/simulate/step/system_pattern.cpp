/// @file system_pattern.cpp
/// Lists the blocks of all elements and springs, and sorts them.
#include "host/simulate/step/system_pattern.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>

#include "host/base/index_of.hpp"
#include "host/base/vector_view.hpp"
#include "host/simulate/step/element_lists.hpp"
#include "kernels/body/point_spring.hpp"

namespace tetwarp {
namespace {
class PatternMaker {
 public:
  explicit PatternMaker(const Model& model) : model_(model) {}

  SystemPattern make() {
    number_rows();
    collect_elements();
    list_columns();
    list_upper_blocks();
    return std::move(pattern_);
  }

 private:
  static constexpr std::int32_t no_island = std::numeric_limits<std::int32_t>::max();

  /// Island of every block with unknowns; no_island for prescribed blocks.
  std::vector<std::int32_t> islands_of_blocks() const {
    std::vector<std::int32_t> island(index_of(model_.block_count()), no_island);
    for (std::size_t body = 0; body < model_.body_island.size(); ++body) {
      const auto take = [&](std::int64_t block) {
        if (model_.prescribed[index_of(block)] != 0) return;
        if (model_.body_island[body] < 0 || model_.body_island[body] >= model_.island_count) {
          throw std::invalid_argument("simulation: body " + std::to_string(body) +
                                      " has unknowns but no coupling island");
        }
        island[index_of(block)] = model_.body_island[body];
      };
      for (std::int64_t n = model_.body_node[body]; n < model_.body_node[body + 1]; ++n) take(n);
      if (model_.body_rigid[body] < 0) continue;
      const std::int64_t first = model_.node_count + 2 * std::int64_t{model_.body_rigid[body]};
      take(first);
      take(first + 1);
    }
    return island;
  }

  void number_rows() {
    const std::vector<std::int32_t> island = islands_of_blocks();
    const std::int32_t count = checked_int32(model_.block_count());
    pattern_.row_count = count;
    pattern_.island_start.assign(index_of(model_.island_count) + 1, 0);
    for (const std::int32_t i : island) {
      if (i != no_island) ++pattern_.island_start[index_of(i) + 1];
    }
    for (std::size_t i = 1; i < pattern_.island_start.size(); ++i) {
      pattern_.island_start[i] += pattern_.island_start[i - 1];
    }
    pattern_.unknown_count = pattern_.island_start.back();
    std::vector<std::int32_t> next = pattern_.island_start;
    std::int32_t next_prescribed = pattern_.unknown_count;
    pattern_.block_of.resize(index_of(count));
    pattern_.row_of.resize(index_of(count));
    for (std::int32_t block = 0; block < count; ++block) {
      const std::int32_t i = island[index_of(block)];
      const std::int32_t row = i == no_island ? next_prescribed++ : next[index_of(i)]++;
      pattern_.row_of[index_of(block)] = row;
      pattern_.block_of[index_of(row)] = block;
    }
    pattern_.pair.assign(index_of(count), 0);
    for (std::int64_t b = 0; b < model_.rigid_count; ++b) {
      const std::int64_t block = model_.node_count + 2 * b;
      const std::int32_t row = pattern_.row_of[index_of(block)];
      if (row >= pattern_.unknown_count || pattern_.row_of[index_of(block) + 1] != row + 1)
        continue;
      if (row + 1 >= pattern_.unknown_count) continue;
      pattern_.pair[index_of(row)] = 1;
      pattern_.pair[index_of(row) + 1] = 2;
    }
  }

  std::int32_t row_of_node(std::int64_t node) const {
    if (node < 0 || node >= model_.node_count) {
      throw std::invalid_argument("simulation: node " + std::to_string(node) + " does not exist");
    }
    return pattern_.row_of[index_of(node)];
  }

  void set_slots(const ModelPoint& point, std::int32_t* rows) const {
    std::fill_n(rows, point_slots, -1);
    if (point.rigid >= model_.rigid_count) {
      throw std::invalid_argument("simulation: rigid body " + std::to_string(point.rigid) +
                                  " does not exist");
    }
    if (point.rigid >= 0) {
      const std::int64_t block = model_.node_count + 2 * std::int64_t{point.rigid};
      rows[0] = pattern_.row_of[index_of(block)];
      rows[1] = pattern_.row_of[index_of(block) + 1];
      return;
    }
    for (int k = 0; k < 4 && point.node[index_of(k)] >= 0; ++k)
      rows[k] = row_of_node(point.node[index_of(k)]);
  }

  void collect_elements() {
    for (const auto& nodes : model_.tets.nodes) {
      auto& rows = tets_.rows.emplace_back();
      for (std::size_t a = 0; a < 4; ++a) rows[a] = row_of_node(nodes[a]);
    }
    for (const auto& nodes : model_.edges.nodes) {
      edges_.rows.push_back({row_of_node(nodes[0]), row_of_node(nodes[1])});
    }
    for (std::size_t s = 0; s < model_.springs.a.size(); ++s) {
      auto& rows = springs_.rows.emplace_back();
      set_slots(model_.springs.a[s], rows.data());
      set_slots(model_.springs.b[s], rows.data() + point_slots);
      if (model_.springs.handle[s] >= 0) std::fill_n(rows.data() + point_slots, point_slots, -1);
    }
    pattern_.tets.rows = tets_.incidences(pattern_.row_count);
    pattern_.edges.rows = edges_.incidences(pattern_.row_count);
    pattern_.springs.rows = springs_.incidences(pattern_.row_count);
    const auto& entries = model_.scalar_blocks.nodes;
    pattern_.scalar_start.assign(index_of(model_.node_count) + 1, 0);
    for (std::size_t e = 0; e < entries.size(); ++e) {
      row_of_node(entries[e][0]);
      row_of_node(entries[e][1]);
      if (e > 0 && !(entries[e - 1] < entries[e])) {
        throw std::invalid_argument("simulation: scalar blocks are not sorted");
      }
      ++pattern_.scalar_start[index_of(entries[e][0]) + 1];
    }
    for (std::size_t n = 1; n < pattern_.scalar_start.size(); ++n) {
      pattern_.scalar_start[n] += pattern_.scalar_start[n - 1];
    }
  }

  /// Calls visit(column) for every block of a row, the diagonal included, also repeatedly.
  template <class Visit>
  void for_each_column(std::int32_t row, const Visit& visit) const {
    visit(row);
    const std::int32_t block = pattern_.block_of[index_of(row)];
    if (block < model_.node_count) {
      for (std::int32_t e = pattern_.scalar_start[index_of(block)];
           e < pattern_.scalar_start[index_of(block) + 1]; ++e) {
        visit(pattern_.row_of[index_of(model_.scalar_blocks.nodes[index_of(e)][1])]);
      }
    } else if (pattern_.pair[index_of(row)] != 0) {
      visit(pattern_.pair[index_of(row)] == 1 ? row + 1 : row - 1);
    }
    const auto take = [&](std::int32_t column, std::uint32_t) { visit(column); };
    for_each_coupling(tets_, pattern_.tets.rows, row, take);
    for_each_coupling(edges_, pattern_.edges.rows, row, take);
    for_each_coupling(springs_, pattern_.springs.rows, row, take);
  }

  void list_columns() {
    std::vector<std::int32_t> seen_by(index_of(pattern_.row_count), -1);
    pattern_.start.push_back(0);
    for (std::int32_t row = 0; row < pattern_.row_count; ++row) {
      const std::size_t first = pattern_.column.size();
      for_each_column(row, [&](std::int32_t column) {
        if (seen_by[index_of(column)] == row) return;
        seen_by[index_of(column)] = row;
        pattern_.column.push_back(column);
      });
      const auto begin = pattern_.column.begin() + static_cast<std::ptrdiff_t>(first);
      std::sort(begin, pattern_.column.end());
      const auto place_of = [&](std::int32_t column) {
        const auto place = std::lower_bound(begin, pattern_.column.end(), column);
        return checked_int32(place - pattern_.column.begin());
      };
      pattern_.free_end.push_back(place_of(pattern_.unknown_count));
      pattern_.diagonal.push_back(place_of(row));
      pattern_.start.push_back(checked_int32(static_cast<std::int64_t>(pattern_.column.size())));
    }
  }

  std::int32_t place_of(std::int32_t row, std::int32_t column) const {
    const auto begin = pattern_.column.begin() + pattern_.start[index_of(row)];
    const auto end = pattern_.column.begin() + pattern_.start[index_of(row) + 1];
    return static_cast<std::int32_t>(std::lower_bound(begin, end, column) -
                                     pattern_.column.begin());
  }

  void list_upper_blocks() {
    std::vector<std::int32_t> upper_of(index_of(pattern_.row_count));  // of the columns of the row
    for (std::int32_t row = 0; row < pattern_.row_count; ++row) {
      const std::size_t first = pattern_.upper.size();
      for (std::int32_t k = pattern_.diagonal[index_of(row)]; k < pattern_.start[index_of(row) + 1];
           ++k) {
        const std::int32_t column = pattern_.column[index_of(k)];
        upper_of[index_of(column)] = static_cast<std::int32_t>(pattern_.upper.size());
        pattern_.upper.push_back({k, place_of(column, row), -1, -1});
      }
      set_constants(row, upper_of);
      append_items(tets_, pattern_.tets, row, first, upper_of);
      append_items(edges_, pattern_.edges, row, first, upper_of);
      append_items(springs_, pattern_.springs, row, first, upper_of);
    }
  }

  void set_constants(std::int32_t row, const std::vector<std::int32_t>& upper_of) {
    const std::int32_t block = pattern_.block_of[index_of(row)];
    if (block >= model_.node_count) {
      pattern_.upper[index_of(upper_of[index_of(row)])].rigid = block - model_.node_count;
      return;
    }
    for (std::int32_t e = pattern_.scalar_start[index_of(block)];
         e < pattern_.scalar_start[index_of(block) + 1]; ++e) {
      const std::int32_t column =
          pattern_.row_of[index_of(model_.scalar_blocks.nodes[index_of(e)][1])];
      if (column >= row) pattern_.upper[index_of(upper_of[index_of(column)])].scalar = e;
    }
  }

  /// Appends the items of the row's upper blocks, which are `first` and those after it.
  template <int slots>
  void append_items(const Elements<slots>& elements,
                    ElementArrays& lists,
                    std::int32_t row,
                    std::size_t first,
                    const std::vector<std::int32_t>& upper_of) {
    if (elements.rows.empty()) return;
    counts_.assign(pattern_.upper.size() - first, 0);
    const auto each = [&](const auto& use) {
      for_each_coupling(elements, lists.rows, row, [&](std::int32_t column, std::uint32_t item) {
        if (column >= row) use(index_of(upper_of[index_of(column)]) - first, item);
      });
    };
    each([&](std::size_t k, std::uint32_t) { ++counts_[k]; });
    std::int64_t next = static_cast<std::int64_t>(lists.blocks.item.size());
    if (lists.blocks.start.empty()) lists.blocks.start.push_back(0);
    for (std::int64_t& count : counts_) {
      const std::int64_t size = count;
      count = next;
      next += size;
      lists.blocks.start.push_back(checked_int32(next));
    }
    lists.blocks.item.resize(index_of(next));
    each([&](std::size_t k, std::uint32_t item) {
      lists.blocks.item[index_of(counts_[k]++)] = item;
    });
  }

  const Model& model_;
  SystemPattern pattern_;
  Elements<4> tets_;
  Elements<2> edges_;
  Elements<spring_slots> springs_;
  std::vector<std::int64_t> counts_;
};
}  // namespace

SystemPattern make_system_pattern(const Model& model) {
  return PatternMaker(model).make();
}

SystemRows rows_of(const SystemPattern& pattern) {
  SystemRows rows;
  rows.count = pattern.row_count;
  rows.unknown_count = pattern.unknown_count;
  rows.block_of = view_of(pattern.block_of);
  rows.start = view_of(pattern.start);
  rows.free_end = view_of(pattern.free_end);
  rows.column = view_of(pattern.column);
  rows.diagonal = view_of(pattern.diagonal);
  rows.pair = view_of(pattern.pair);
  return rows;
}

}  // namespace tetwarp

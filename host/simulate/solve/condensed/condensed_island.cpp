/// @file condensed_island.cpp
/// Factors and columns, kept as long as A is the same.
#include "host/simulate/solve/condensed/condensed_island.hpp"

#include <algorithm>
#include <utility>

#include "host/base/index_of.hpp"

namespace tetwarp {

void CondensedIsland::set(SystemIslands::Range range) {
  range_ = range;
  has_pattern_ = false;
  factors_ = nullptr;
  values_.clear();
  forget_columns();
}

const RowRangeLu& CondensedIsland::pattern(const SystemRows& rows) {
  if (!std::exchange(has_pattern_, true)) lu_.set(rows, range_.begin, range_.end);
  return lu_;
}

bool CondensedIsland::factor(const StepSystem& system, RowRangeLu* made) {
  const double* const begin =
      system.values.data + 9 * std::int64_t{system.rows.start[range_.begin]};
  const double* const end = system.values.data + 9 * std::int64_t{system.rows.start[range_.end]};
  const bool is_same = std::equal(begin, end, values_.begin(), values_.end());
  if (!is_same) {
    values_.assign(begin, end);
    forget_columns();
  }
  const bool is_kept = is_same && factors_ == &lu_;
  factors_ = made != nullptr ? made : &lu_;
  if (made != nullptr || is_kept) return true;
  pattern(system.rows);
  if (lu_.factor(system.rows, system.values)) return true;
  values_.clear();
  return false;
}

void CondensedIsland::solve(std::vector<double>& x) {
  factors_->solve({x.data() + 3 * std::int64_t{range_.begin},
                   index_of(3 * std::int64_t{range_.end - range_.begin})});
}

std::vector<double> CondensedIsland::solved_columns(const Key& key) {
  const std::size_t size = 3 * index_of(range_.end - range_.begin);
  std::vector<double> columns(3 * size, 0.0);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double* const column = columns.data() + axis * size;
    for (std::size_t e = 0; e < key.size(); e += 10) {
      const std::int64_t place = static_cast<std::int64_t>(key[e]) - range_.begin;
      std::copy_n(key.data() + e + 1 + 3 * axis, 3, column + 3 * place);
    }
  }
  factors_->solve_three(columns);
  return columns;
}

void CondensedIsland::find_columns(const BlockJacobian& jacobian,
                                   const std::vector<std::int32_t>& contacts) {
  std::map<Key, std::vector<double>> before;
  before.swap(columns_);
  contacts_.clear();
  for (const std::int32_t contact : contacts) {
    Key key;
    jacobian.for_blocks(index_of(contact), [&](std::size_t b) {
      if (!has(jacobian.row()[b])) return;
      key.push_back(jacobian.row()[b]);
      key.insert(key.end(), jacobian.block(b), jacobian.block(b) + 9);
    });
    auto own = columns_.find(key);
    if (own == columns_.end()) {
      auto kept = before.extract(key);
      own = !kept.empty() ? columns_.insert(std::move(kept)).position
                          : columns_.emplace(key, solved_columns(key)).first;
    }
    contacts_.push_back({contact, &own->second});
  }
}

void CondensedIsland::forget_columns() {
  columns_.clear();
  contacts_.clear();
}

}  // namespace tetwarp

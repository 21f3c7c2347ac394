/// @file touching_matrix.cpp
/// Lists the blocks, and adds those of the system and of contacts.
#include "host/simulate/solve/two_level/touching_matrix.hpp"

#include <algorithm>

#include "host/base/index_of.hpp"
#include "host/simulate/step/cpu/system_blocks.hpp"

namespace tetwarp {
namespace {

constexpr std::int64_t most_rows = 4096;  // of the search for an order of little fill

}  // namespace

bool TouchingMatrix::set(const StepSystem& system,
                         const CompliantLists& lists,
                         const TouchingBlocks& blocks,
                         std::int64_t most_operations) {
  lists_ = &lists;
  blocks_ = &blocks;
  if (lists.row_count() > most_rows) return false;
  list_system(system);
  const auto count = static_cast<std::int32_t>(lists.row_count());
  of_system_.set_pattern(count, entries_);
  if (of_system_.operations() > most_operations) return false;
  list_contacts();
  lu_.set_pattern(count, entries_);
  return lu_.operations() <= most_operations;
}

/// Lists the blocks of A off the diagonal.
void TouchingMatrix::list_system(const StepSystem& system) {
  entries_.clear();
  for (std::int32_t row = 0; row < lists_->row_count(); ++row) {
    list_system_row(system.rows, lists_->system_row[index_of(row)], row, entries_);
  }
}

/// Adds the blocks between the rows that contacts move.
void TouchingMatrix::list_contacts() {
  for (std::size_t c = 0; c < index_of(blocks_->count()); ++c) {
    moved_.clear();
    blocks_->for_blocks(c, [&](std::size_t b) { moved_.push_back(blocks_->row()[b]); });
    for (const std::int32_t i : moved_) {
      for (const std::int32_t j : moved_) {
        if (i != j) entries_.push_back({i, j});
      }
    }
  }
  std::ranges::sort(entries_);
  entries_.erase(std::unique(entries_.begin(), entries_.end()), entries_.end());
}

/// Adds J_p^T H J_q of all blocks of a contact.
void TouchingMatrix::add_contact(std::size_t contact, const double* slope) {
  blocks_->for_blocks(contact, [&](std::size_t q) {
    const double* const second = blocks_->jacobian(q);
    double pull[9];  // H J_q, row by row
    for (int e = 0; e < 9; ++e) {
      const double* const h = slope + e / 3 * 3;
      pull[e] = h[0] * second[e % 3] + h[1] * second[3 + e % 3] + h[2] * second[6 + e % 3];
    }
    blocks_->for_blocks(contact, [&](std::size_t p) {
      const double* const first = blocks_->jacobian(p);
      double block[9];
      for (int e = 0; e < 9; ++e) {
        block[e] = first[e / 3] * pull[e % 3] + first[3 + e / 3] * pull[3 + e % 3] +
                   first[6 + e / 3] * pull[6 + e % 3];
      }
      lu_.add(blocks_->row()[p], blocks_->row()[q], block);
    });
  });
}

bool TouchingMatrix::factor(const StepSystem& system, const std::vector<double>& slope) {
  lu_.clear();
  for (std::int32_t row = 0; row < lists_->row_count(); ++row) {
    add_system_row(system.rows, system.values, lists_->system_row[index_of(row)], row, lu_);
  }
  for (std::size_t c = 0; c < index_of(blocks_->count()); ++c) {
    const double* const own = slope.data() + 9 * c;
    if (std::any_of(own, own + 9, [](double value) { return value != 0; })) add_contact(c, own);
  }
  return lu_.factor();
}

}  // namespace tetwarp

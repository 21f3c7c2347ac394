/// @file touching_matrix.cpp
/// Lists the blocks, and adds those of the system and of contacts.
#include "host/simulate/solve/two_level/touching_matrix.hpp"

#include <algorithm>

#include "host/base/index_of.hpp"

namespace tetwarp {
namespace {

constexpr std::size_t most_rows = 1024;
constexpr std::int64_t most_operations = 4'000'000;  // of a factorization, about a millisecond

}  // namespace

bool TouchingMatrix::set(const StepSystem& system,
                         const TakenIslands& islands,
                         const TouchingBlocks& blocks) {
  blocks_ = &blocks;
  if (!list_system(system, islands)) return false;
  const auto count = static_cast<std::int32_t>(rows_.size());
  of_system_.set_pattern(count, entries_);
  if (of_system_.operations() > most_operations) return false;
  list_contacts();
  lu_.set_pattern(count, entries_);
  packed_.resize(3 * rows_.size());
  return lu_.operations() <= most_operations;
}

/// Lists the blocks of A off the diagonal. @returns false where there are too many rows
bool TouchingMatrix::list_system(const StepSystem& system, const TakenIslands& islands) {
  rows_.clear();
  entries_.clear();
  index_of_row_.assign(index_of(system.rows.unknown_count), -1);
  for (const IslandRange& island : islands.list()) {
    for (std::int32_t row = island.row_begin; row < island.row_end; ++row) {
      index_of_row_[index_of(row)] = static_cast<std::int32_t>(rows_.size());
      rows_.push_back(row);
    }
    if (rows_.size() > most_rows) return false;
  }
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const std::int32_t row = rows_[i];
    for (std::int32_t k = system.rows.start[row]; k < system.rows.free_end[row]; ++k) {
      const std::int32_t column = system.rows.column[k];
      if (column == row) continue;
      entries_.push_back({static_cast<std::int32_t>(i), index_of_row_[index_of(column)]});
    }
  }
  return true;
}

/// Adds the blocks between the rows that contacts move.
void TouchingMatrix::list_contacts() {
  for (std::size_t c = 0; c < index_of(blocks_->count()); ++c) {
    moved_.clear();
    for (std::int32_t p = blocks_->part_start()[c]; p < blocks_->part_start()[c + 1]; ++p) {
      const std::int32_t row = index_of_row_[index_of(blocks_->part_row()[index_of(p)])];
      for (std::int32_t k = 0; k < blocks_->part(p).size / 3; ++k) moved_.push_back(row + k);
    }
    for (const std::int32_t i : moved_) {
      for (const std::int32_t j : moved_) {
        if (i != j) entries_.push_back({i, j});
      }
    }
  }
  std::ranges::sort(entries_);
  entries_.erase(std::unique(entries_.begin(), entries_.end()), entries_.end());
}

/// The blocks of the system are stored column by column.
void TouchingMatrix::add_system(const StepSystem& system) {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const std::int32_t row = rows_[i];
    for (std::int32_t k = system.rows.start[row]; k < system.rows.free_end[row]; ++k) {
      const double* const a = system.values.data + 9 * std::int64_t{k};
      const double block[9] = {a[0], a[3], a[6], a[1], a[4], a[7], a[2], a[5], a[8]};
      lu_.add(static_cast<std::int32_t>(i), index_of_row_[index_of(system.rows.column[k])], block);
    }
  }
}

/// Adds J_p^T H J_q of all parts of a contact.
void TouchingMatrix::add_contact(std::size_t contact, const double* slope) {
  const std::int32_t begin = blocks_->part_start()[contact];
  const std::int32_t end = blocks_->part_start()[contact + 1];
  for (std::int32_t q = begin; q < end; ++q) {
    const TouchingBlocks::Part& second = blocks_->part(q);
    const double* const jq = blocks_->jacobian(second);
    const std::int32_t column = index_of_row_[index_of(blocks_->part_row()[index_of(q)])];
    for (std::int32_t n = 0; n < second.size; n += 3) {
      double pull[9];  // H J_q, row by row
      for (int a = 0; a < 3; ++a) {
        for (int j = 0; j < 3; ++j) {
          double sum = 0;
          for (int b = 0; b < 3; ++b) sum += slope[3 * a + b] * jq[b * second.size + n + j];
          pull[3 * a + j] = sum;
        }
      }
      for (std::int32_t p = begin; p < end; ++p) {
        const TouchingBlocks::Part& first = blocks_->part(p);
        const double* const jp = blocks_->jacobian(first);
        const std::int32_t row = index_of_row_[index_of(blocks_->part_row()[index_of(p)])];
        for (std::int32_t m = 0; m < first.size; m += 3) {
          double block[9];
          for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
              double sum = 0;
              for (int a = 0; a < 3; ++a) sum += jp[a * first.size + m + i] * pull[3 * a + j];
              block[3 * i + j] = sum;
            }
          }
          lu_.add(row + m / 3, column + n / 3, block);
        }
      }
    }
  }
}

bool TouchingMatrix::factor(const StepSystem& system, const std::vector<double>& slope) {
  lu_.clear();
  add_system(system);
  for (std::size_t c = 0; c < index_of(blocks_->count()); ++c) {
    const double* const own = slope.data() + 9 * c;
    if (std::any_of(own, own + 9, [](double value) { return value != 0; })) add_contact(c, own);
  }
  return lu_.factor();
}

void TouchingMatrix::solve(std::vector<double>& x) {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    std::copy_n(x.data() + 3 * std::int64_t{rows_[i]}, 3, packed_.data() + 3 * i);
  }
  lu_.solve(packed_);
  std::ranges::fill(x, 0.0);
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    std::copy_n(packed_.data() + 3 * i, 3, x.data() + 3 * std::int64_t{rows_[i]});
  }
}

}  // namespace tetwarp

/// @file system_islands.hpp
/// SystemIslands: the rows of each coupling island in the system of a step.
#pragma once
#include <cstdint>
#include <vector>

#include "host/simulate/solve/problem/contact_islands.hpp"
#include "kernels/body/system_lists.hpp"

namespace tetwarp {

class SystemIslands {
 public:
  /// Rows of an island follow each other.
  struct Range {
    std::int32_t begin = 0, end = 0;
  };

  /// @returns whether rows or blocks differ from those of the call before
  bool set(const SystemRows& rows, const ContactIslands& islands);

  Range of(std::int32_t island) const { return ranges_[static_cast<std::size_t>(island)]; }
  /// Of a row with unknowns.
  std::int32_t of_row(std::int32_t row) const { return of_row_[static_cast<std::size_t>(row)]; }
  const std::vector<std::int32_t>& row_of_block() const { return row_of_block_; }  ///< or -1

 private:
  std::vector<Range> ranges_;               ///< [coupling islands]
  std::vector<std::int32_t> of_row_;        ///< [rows with unknowns] coupling island
  std::vector<std::int32_t> row_of_block_;  ///< [blocks of the model]
  // Of the system.
  std::vector<std::int32_t> block_of_, start_, column_;
};

}  // namespace tetwarp

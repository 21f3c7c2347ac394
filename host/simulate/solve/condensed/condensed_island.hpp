/// @file condensed_island.hpp
/// CondensedIsland: how a coupling island gives way to its contacts, by factors of A.
#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "host/simulate/solve/condensed/system_islands.hpp"
#include "host/simulate/solve/problem/block_jacobian.hpp"
#include "host/simulate/step/cpu/row_range_lu.hpp"
#include "host/simulate/step/stepper.hpp"

namespace tetwarp {

class CondensedIsland {
 public:
  /// A contact and its columns of A^-1 J^T, [3][3 rows of the island].
  struct Contact {
    std::int32_t number;  ///< in the Jacobian
    const std::vector<double>* columns;
  };

  /// Forgets what has been made. @param range  rows of the system
  void set(SystemIslands::Range range);
  SystemIslands::Range range() const { return range_; }
  /// The pattern of its rows, found at the first call.
  const RowRangeLu& pattern(const SystemRows& rows);

  /// Factorizes its part of A, unless the linear solve has.
  /// @param made  factors of the linear solve, or null; kept by the caller
  /// @returns whether all pivots are regular
  bool factor(const StepSystem& system, RowRangeLu* made);
  /// Replaces the numbers of its rows by A^-1 times them. @param x  [rows of the system][3]
  void solve(std::vector<double>& x);
  /// Finds the columns of its contacts. They are kept for the next call as long as contacts have
  /// the same J and A stays the same, as in the passes of a step; others are given back.
  void find_columns(const BlockJacobian& jacobian, const std::vector<std::int32_t>& contacts);
  /// Gives all columns back.
  void forget_columns();
  const std::vector<Contact>& contacts() const { return contacts_; }  ///< ascending
  /// Whether a row is one of its own.
  bool has(std::int32_t row) const { return row >= range_.begin && row < range_.end; }

 private:
  /// J of a contact in the island: of each block its row, and nine numbers.
  using Key = std::vector<double>;

  std::vector<double> solved_columns(const Key& key);

  SystemIslands::Range range_;
  bool has_pattern_ = false;
  RowRangeLu lu_;
  RowRangeLu* factors_ = nullptr;  ///< of the linear solve, or `lu_`
  std::vector<double> values_;     ///< of A, for which factors and columns have been made
  std::map<Key, std::vector<double>> columns_;
  std::vector<Contact> contacts_;
};

}  // namespace tetwarp

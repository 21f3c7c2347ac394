/// @file condensed_matrix.hpp
/// CondensedMatrix: the Delassus matrix W = J A^-1 J^T of contacts.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/contact_problem.hpp>

#include "host/simulate/solve/condensed/condensed_island.hpp"

namespace tetwarp {

/// In dense memory, of which blocks between contacts without a common island are left out.
class CondensedMatrix {
 public:
  /// Sets W to zero, without blocks. @param count  contacts
  void clear(std::size_t count);
  /// Adds the part that is due to an island, after its find_columns().
  void add(const BlockJacobian& jacobian, const CondensedIsland& island);
  /// Whether its numbers are finite, and each contact gives way to its own impulses.
  bool is_valid() const;
  /// Copies it. @param w  out, rows of three numbers per contact
  void copy(SparseMatrix& w) const;
  /// u -= W r. @param normal  r along the normals, [contacts]; velocity  u, [3 contacts]
  void subtract(const std::vector<double>& normal, std::vector<double>& velocity) const;

 private:
  const double* block(std::size_t row, std::size_t column) const {
    return values_.data() + 9 * (row * count_ + column);
  }

  std::size_t count_ = 0;
  std::vector<double> values_;           ///< [contacts][contacts][9], row by row
  std::vector<std::uint8_t> has_block_;  ///< [contacts][contacts]
};

}  // namespace tetwarp

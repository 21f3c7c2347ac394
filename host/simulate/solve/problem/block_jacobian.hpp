/// @file block_jacobian.hpp
/// BlockJacobian: J of some contacts, on the rows of a system.
#pragma once
#include <cstdint>
#include <vector>

#include "host/simulate/solve/problem/contact_rows.hpp"
#include "kernels/contact/touching_rows.hpp"

namespace tetwarp {

/// Each contact has a block for each row on which it acts. Vectors of rows are [rows][3].
class BlockJacobian {
 public:
  /// @param contacts      numbers of the contacts in `rows`; they are numbered anew, in this order
  /// @param row_of_block  [blocks of the model], or -1: left out
  void set(const ContactRows& rows,
           const std::vector<std::int32_t>& contacts,
           const std::vector<std::int32_t>& row_of_block);

  std::int64_t count() const { return static_cast<std::int64_t>(block_start_.size()) - 1; }
  std::size_t block_count() const { return row_.size(); }
  const std::vector<std::int32_t>& block_start() const { return block_start_; }  ///< [contacts + 1]
  const std::vector<std::int32_t>& row() const { return row_; }                  ///< [blocks]
  /// Row by row: velocities along the axes of the contact per velocity of the row.
  const double* block(std::size_t block) const { return value_.data() + 9 * block; }
  /// Calls visit(b) for the blocks of a contact.
  template <class Visit>
  void for_blocks(std::size_t contact, const Visit& visit) const {
    for (std::int32_t b = block_start_[contact]; b < block_start_[contact + 1]; ++b) {
      visit(static_cast<std::size_t>(b));
    }
  }
  /// @param offset  w, [3 contacts]
  TouchingRows rows(const std::vector<double>& offset) const;

  /// u = J v + w.
  /// @param v         [rows][3]
  /// @param velocity  out: u, [3 contacts]
  void velocities(View<const double> v,
                  const std::vector<double>& offset,
                  int threads,
                  View<double> velocity) const;
  /// force += J^T r of one contact.
  void add_push(std::size_t contact, const double* r, double* force) const;
  /// force += J^T r.
  void add_pushes(const double* impulse, double* force) const;

 private:
  std::vector<std::int32_t> block_start_{0}, row_;
  std::vector<double> value_;
};

}  // namespace tetwarp

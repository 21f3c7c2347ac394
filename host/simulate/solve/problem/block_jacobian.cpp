/// @file block_jacobian.cpp
/// Takes J from the rows of contacts; products with it.
#include "host/simulate/solve/problem/block_jacobian.hpp"

#include "host/base/index_of.hpp"
#include "host/base/parallel.hpp"
#include "host/base/vector_view.hpp"

namespace tetwarp {

void BlockJacobian::set(const ContactRows& rows,
                        const std::vector<std::int32_t>& contacts,
                        const std::vector<std::int32_t>& row_of_block) {
  block_start_.assign(1, 0);
  row_.clear();
  value_.clear();
  for (const std::int32_t contact : contacts) {
    const std::size_t end = index_of(rows.start[index_of(contact) + 1]);
    for (std::size_t e = index_of(rows.start[index_of(contact)]); e < end; ++e) {
      const std::int32_t row = row_of_block[index_of(rows.block[e])];
      if (row < 0) continue;
      row_.push_back(row);
      value_.insert(value_.end(), rows.value[e].begin(), rows.value[e].end());
    }
    block_start_.push_back(static_cast<std::int32_t>(row_.size()));
  }
}

TouchingRows BlockJacobian::rows(const std::vector<double>& offset) const {
  TouchingRows rows;
  rows.block_start = view_of(block_start_);
  rows.row = view_of(row_);
  rows.jacobian = view_of(value_);
  rows.offset = view_of(offset);
  return rows;
}

void BlockJacobian::velocities(View<const double> v,
                               const std::vector<double>& offset,
                               int threads,
                               View<double> velocity) const {
  parallel_for(threads, count(), TouchVelocityOp{rows(offset), v, velocity});
}

void BlockJacobian::add_push(std::size_t contact, const double* r, double* force) const {
  for_blocks(contact, [&](std::size_t b) {
    const double* const j = block(b);
    double* const own = force + 3 * std::int64_t{row_[b]};
    for (int k = 0; k < 3; ++k) own[k] += j[k] * r[0] + j[3 + k] * r[1] + j[6 + k] * r[2];
  });
}

void BlockJacobian::add_pushes(const double* impulse, double* force) const {
  for (std::size_t c = 0; c < index_of(count()); ++c) add_push(c, impulse + 3 * c, force);
}

}  // namespace tetwarp

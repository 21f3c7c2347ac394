#include "host/simulate/contact/step_problem.hpp"
#include "host/base/index_of.hpp"

#include <algorithm>

namespace tetwarp {
namespace {

bool is_equal(View<const std::int32_t> a, const std::vector<std::int32_t>& b) {
  return std::equal(a.data, a.data + a.size, b.begin(), b.end());
}

}  // namespace

void StepProblem::set(const StepSystem& system,
                      const ContactIslands& islands,
                      const ContactRows& rows,
                      const std::vector<std::uint8_t>& takes,
                      const std::vector<std::int32_t>& contacts) {
  if (takes != takes_ || !has_pattern(system.rows)) {
    takes_ = takes;
    set_pattern(system, islands);
  }
  set_values(system);
  set_jacobian(rows, contacts);
}

bool StepProblem::has_pattern(const SystemRows& rows) const {
  return is_equal(rows.start, start_) && is_equal(rows.column, column_);
}

void StepProblem::set_pattern(const StepSystem& system, const ContactIslands& islands) {
  const SystemRows& rows = system.rows;
  start_.assign(rows.start.data, rows.start.data + rows.start.size);
  column_.assign(rows.column.data, rows.column.data + rows.column.size);
  rows_.clear();
  dof_of_.assign(index_of(rows.block_of.size), -1);
  problem_.block_start.clear();
  for (std::int32_t row = 0; row < rows.unknown_count; ++row) {
    const std::int32_t block = rows.block_of[row];
    if (takes_[index_of(islands.of_block(block))] == 0) continue;
    const auto dof = static_cast<std::int32_t>(3 * rows_.size());
    dof_of_[index_of(block)] = dof;
    if (rows.pair[row] != 2) problem_.block_start.push_back(dof);
    rows_.push_back(row);
  }
  const auto dofs = static_cast<std::int64_t>(3 * rows_.size());
  problem_.block_start.push_back(static_cast<std::int32_t>(dofs));
  SparseMatrix& a = problem_.system;
  a.rows = a.columns = dofs;
  a.row_start.assign(1, 0);
  a.column.clear();
  for (const std::int32_t row : rows_) {
    for (int i = 0; i < 3; ++i) {
      for (std::int32_t k = rows.start[row]; k < rows.free_end[row]; ++k) {
        const std::int32_t dof = dof_of_[index_of(rows.block_of[rows.column[k]])];
        a.column.insert(a.column.end(), {dof, dof + 1, dof + 2});
      }
      a.row_start.push_back(static_cast<std::int64_t>(a.column.size()));
    }
  }
  a.value.resize(a.column.size());
}

void StepProblem::set_values(const StepSystem& system) {
  double* out = problem_.system.value.data();
  problem_.load.resize(3 * rows_.size());
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const std::int32_t row = rows_[r];
    const std::int32_t begin = system.rows.start[row], end = system.rows.free_end[row];
    for (int i = 0; i < 3; ++i) {
      problem_.load[3 * r + index_of(i)] = system.load[3 * std::int64_t{row} + i];
      for (std::int32_t k = begin; k < end; ++k, out += 3) {
        const double* const block = system.values.data + 9 * std::int64_t{k} + i;
        out[0] = block[0], out[1] = block[3], out[2] = block[6];
      }
    }
  }
}

void StepProblem::set_jacobian(const ContactRows& rows, const std::vector<std::int32_t>& contacts) {
  SparseMatrix& j = problem_.jacobian;
  j.rows = static_cast<std::int64_t>(3 * contacts.size());
  j.columns = problem_.system.rows;
  j.row_start.assign(1, 0);
  j.column.clear();
  j.value.clear();
  for (const std::int32_t contact : contacts) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::int32_t e = rows.start[index_of(contact)]; e < rows.start[index_of(contact) + 1];
           ++e) {
        const std::int32_t dof = dof_of_[index_of(rows.block[index_of(e)])];
        if (dof < 0) continue;
        const double* const value = rows.value[index_of(e)].data() + 3 * axis;
        j.column.insert(j.column.end(), {dof, dof + 1, dof + 2});
        j.value.insert(j.value.end(), value, value + 3);
      }
      j.row_start.push_back(static_cast<std::int64_t>(j.column.size()));
    }
  }
}

void StepProblem::scatter(std::span<const double> dofs, std::vector<Point3>& velocity) const {
  for (std::size_t block = 0; block < dof_of_.size(); ++block) {
    if (dof_of_[block] < 0) continue;
    for (std::size_t i = 0; i < 3; ++i) velocity[block][i] = dofs[index_of(dof_of_[block]) + i];
  }
}

}  // namespace tetwarp

/// @file step_problem.cpp
/// Makes the lists of a problem when its pattern has changed, and fills its numbers.
#include "host/simulate/solve/problem/step_problem.hpp"

#include <algorithm>
#include <utility>

#include "host/base/index_of.hpp"

namespace tetwarp {
namespace {

bool is_equal(View<const std::int32_t> a, const std::vector<std::int32_t>& b) {
  return std::equal(a.data, a.data + a.size, b.begin(), b.end());
}

template <class T>
View<const T> view_in(const std::vector<T>& values) {
  return {values.data(), static_cast<std::int64_t>(values.size())};
}
View<double> view_in(std::vector<double>& values) {
  return {values.data(), static_cast<std::int64_t>(values.size())};
}

template <class Op>
void for_each(std::size_t count, const Op& op) {
  for (std::size_t i = 0; i < count; ++i) op(static_cast<std::int64_t>(i));
}

}  // namespace

bool StepProblem::set_pattern(const SystemRows& rows,
                              const ContactIslands& islands,
                              const ContactRows& contact_rows,
                              const std::vector<std::uint8_t>& takes,
                              const std::vector<std::int32_t>& contacts) {
  const bool is_other_system = takes != takes_ || !has_system_pattern(rows);
  if (is_other_system) {
    takes_ = takes;
    set_system_pattern(rows, islands);
  }
  const bool has_other_arms = set_arms(contact_rows, contacts);
  if (is_other_system || has_other_arms) set_jacobian_pattern(contacts.size());
  return is_other_system || has_other_arms;
}

bool StepProblem::has_system_pattern(const SystemRows& rows) const {
  return is_equal(rows.start, start_) && is_equal(rows.column, column_);
}

void StepProblem::set_system_pattern(const SystemRows& rows, const ContactIslands& islands) {
  start_.assign(rows.start.data, rows.start.data + rows.start.size);
  column_.assign(rows.column.data, rows.column.data + rows.column.size);
  places_.rows.clear();
  places_.model_block.clear();
  places_.blocks.clear();
  dof_of_.assign(index_of(rows.block_of.size), -1);
  problem_.block_start.clear();
  for (std::int32_t row = 0; row < rows.unknown_count; ++row) {
    const std::int32_t block = rows.block_of[row];
    if (takes_[index_of(islands.of_block(block))] == 0) continue;
    const auto dof = static_cast<std::int32_t>(3 * places_.rows.size());
    dof_of_[index_of(block)] = dof;
    if (rows.pair[row] != 2) problem_.block_start.push_back(dof);
    places_.rows.push_back(row);
    places_.model_block.push_back(block);
  }
  const auto dofs = static_cast<std::int64_t>(3 * places_.rows.size());
  problem_.block_start.push_back(static_cast<std::int32_t>(dofs));
  SparseMatrix& a = problem_.system;
  a.rows = a.columns = dofs;
  a.row_start.assign(1, 0);
  a.column.clear();
  for (const std::int32_t row : places_.rows) {
    const std::int32_t begin = rows.start[row], end = rows.free_end[row];
    for (std::int32_t k = begin; k < end; ++k) {
      const std::int64_t first = a.row_start.back() + 3 * std::int64_t{k - begin};
      places_.blocks.push_back({k, 3 * (end - begin), first});
    }
    for (int i = 0; i < 3; ++i) {
      for (std::int32_t k = begin; k < end; ++k) {
        const std::int32_t dof = dof_of_[index_of(rows.block_of[rows.column[k]])];
        a.column.insert(a.column.end(), {dof, dof + 1, dof + 2});
      }
      a.row_start.push_back(static_cast<std::int64_t>(a.column.size()));
    }
  }
  places_.system_size = static_cast<std::int64_t>(a.column.size());
}

bool StepProblem::set_arms(const ContactRows& contact_rows,
                           const std::vector<std::int32_t>& contacts) {
  arms_.axes.clear();
  arms_.arms.clear();
  arm_places_.clear();
  next_block_.clear();
  std::int32_t numbers = 0;
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const std::size_t contact = index_of(contacts[k]);
    const auto axes = contact_rows.axes.begin() + static_cast<std::ptrdiff_t>(9 * contact);
    arms_.axes.insert(arms_.axes.end(), axes, axes + 9);
    const std::size_t first_arm = arm_places_.size();
    std::int32_t width = 0;  // length of a row of the contact
    for (std::int32_t a = contact_rows.arm_start[contact]; a < contact_rows.arm_start[contact + 1];
         ++a) {
      const std::int32_t block = contact_rows.block_of_arm(a);
      if (dof_of_[index_of(block)] < 0) continue;
      const bool is_frame = contact_rows.places[index_of(a)].angular != 0;
      arms_.arms.push_back(contact_rows.arms[index_of(a)]);
      arm_places_.push_back({static_cast<std::int32_t>(k), numbers + width, 0, is_frame ? 3 : 0});
      next_block_.push_back(block);
      width += is_frame ? 6 : 3;
    }
    for (std::size_t a = first_arm; a < arm_places_.size(); ++a) arm_places_[a].stride = width;
    numbers += 3 * width;
  }
  const bool is_same = arm_places_ == places_.arms && next_block_ == arm_block_ &&
                       problem_.jacobian.rows == static_cast<std::int64_t>(3 * contacts.size());
  std::swap(arm_places_, places_.arms);
  std::swap(next_block_, arm_block_);
  places_.jacobian_size = numbers;
  return !is_same;
}

void StepProblem::set_jacobian_pattern(std::size_t contact_count) {
  SparseMatrix& j = problem_.jacobian;
  j.rows = static_cast<std::int64_t>(3 * contact_count);
  j.columns = problem_.system.rows;
  j.row_start.assign(1, 0);
  j.column.clear();
  std::size_t begin = 0, end = 0;
  for (std::size_t contact = 0; contact < contact_count; ++contact, begin = end) {
    while (end < arm_block_.size() && index_of(places_.arms[end].contact) == contact) ++end;
    for (int axis = 0; axis < 3; ++axis) {
      for (std::size_t a = begin; a < end; ++a) {
        const std::size_t block = index_of(arm_block_[a]);
        const auto add = [&](std::int32_t dof) {
          j.column.insert(j.column.end(), {dof, dof + 1, dof + 2});
        };
        add(dof_of_[block]);
        if (places_.arms[a].angular != 0) add(dof_of_[block + 1]);
      }
      j.row_start.push_back(static_cast<std::int64_t>(j.column.size()));
    }
  }
}

void StepProblem::set_numbers(const StepSystem& system) {
  problem_.system.value.resize(problem_.system.column.size());
  problem_.jacobian.value.resize(problem_.jacobian.column.size());
  problem_.load.resize(3 * places_.rows.size());
  for_each(places_.blocks.size(),
           SystemGatherOp{view_in(places_.blocks), system.values, view_in(problem_.system.value)});
  for_each(places_.rows.size(),
           GatherThreeOp{view_in(places_.rows), system.load, view_in(problem_.load)});
  for_each(places_.arms.size(),
           ContactRowsOp{view_in(arms_.axes), view_in(arms_.arms), view_in(places_.arms),
                         view_in(problem_.jacobian.value)});
}

void StepProblem::set_sample() {
  SparseMatrix& a = problem_.system;
  a.value.assign(a.column.size(), 0);
  for (std::size_t row = 0; row + 1 < a.row_start.size(); ++row) {
    for (std::int64_t e = a.row_start[row]; e < a.row_start[row + 1]; ++e) {
      if (index_of(a.column[index_of(e)]) == row) a.value[index_of(e)] = 1;
    }
  }
  problem_.jacobian.value.assign(problem_.jacobian.column.size(), 1);
  problem_.load.assign(3 * places_.rows.size(), 0);
}

void StepProblem::scatter(std::span<const double> dofs, std::vector<Point3>& velocity) const {
  for_each(
      places_.model_block.size(),
      ScatterThreeOp{view_in(places_.model_block),
                     {dofs.data(), static_cast<std::int64_t>(dofs.size())},
                     {velocity.data()->data(), static_cast<std::int64_t>(3 * velocity.size())}});
}

}  // namespace tetwarp

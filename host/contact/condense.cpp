/// @file condense.cpp
#include "host/contact/condense.hpp"

#include <algorithm>

#include "host/contact/problem/matrix.hpp"

namespace tetwarp {

using Eigen::Index;
using Eigen::VectorXd;

CondensedProblem::CondensedProblem(const ContactProblem& problem)
    : jacobian_(make_eigen(problem.jacobian)) {
  factor_.factorize(make_eigen(problem.system));
  const Index rows = jacobian_.rows();
  constexpr Index run = 48;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> delassus(rows, rows);
  for (Index first = 0; first < rows; first += run) {
    const Index count = std::min(run, rows - first);
    const Eigen::MatrixXd pushes = jacobian_.middleRows(first, count).transpose();
    delassus.middleCols(first, count) = jacobian_ * factor_.solve(pushes);
  }
  local_.delassus.rows = local_.delassus.columns = rows;
  for (Index row = 0; row <= rows; ++row) local_.delassus.row_start.push_back(row * rows);
  for (Index row = 0; row < rows; ++row) {
    for (Index column = 0; column < rows; ++column) {
      local_.delassus.column.push_back(static_cast<std::int32_t>(column));
    }
  }
  local_.delassus.value.assign(delassus.data(), delassus.data() + delassus.size());
  update(problem);
}

void CondensedProblem::update(const ContactProblem& problem) {
  load_ = Eigen::Map<const VectorXd>(problem.load.data(), static_cast<Index>(problem.load.size()));
  local_.friction = problem.friction;
  local_.adhesion = problem.adhesion;
  local_.impulse_guess = problem.impulse_guess;
  local_.free_velocity = problem.velocity_offset;
  if (local_.free_velocity.empty()) return;
  const VectorXd free = jacobian_ * factor_.solve(load_);
  for (std::size_t row = 0; row < local_.free_velocity.size(); ++row) {
    local_.free_velocity[row] += free(static_cast<Index>(row));
  }
}

std::vector<double> CondensedProblem::body_velocity(const std::vector<double>& impulse) const {
  const Eigen::Map<const VectorXd> r(impulse.data(), static_cast<Index>(impulse.size()));
  const VectorXd push = load_ + jacobian_.transpose() * r;
  const VectorXd v = factor_.solve(push);
  return {v.data(), v.data() + v.size()};
}

}  // namespace tetwarp

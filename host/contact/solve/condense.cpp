/// @file condense.cpp
/// Factorizes A and makes the Delassus matrix.
#include "host/contact/solve/condense.hpp"

#include <algorithm>

#include "host/contact/problem/matrix.hpp"

namespace tetwarp {

using Eigen::Index;
using Eigen::VectorXd;

CondensedProblem::CondensedProblem(const ContactProblem& problem, SolveBudget* budget)
    : jacobian_(make_eigen(problem.jacobian)) {
  factor_.factorize(make_eigen(problem.system));
  const Index rows = jacobian_.rows(), contacts = rows / 3;
  constexpr Index columns_at_once = 48;  // a multiple of 3
  std::vector<double>& blocks = local_.delassus.value;
  blocks.resize(static_cast<std::size_t>(rows * rows));
  for (Index first = 0; first < rows; first += columns_at_once) {
    if (budget != nullptr && budget->is_over()) throw BudgetOver();
    const Index count = std::min(columns_at_once, rows - first);
    const Eigen::MatrixXd pushes = jacobian_.middleRows(first, count).transpose();
    const Eigen::MatrixXd columns = jacobian_ * factor_.solve(pushes);
    for (Index row = 0; row < rows; ++row) {
      for (Index k = 0; k < count; ++k) {
        const Index block = row / 3 * contacts + (first + k) / 3;
        blocks[static_cast<std::size_t>(9 * block + 3 * (row % 3) + (first + k) % 3)] =
            columns(row, k);
      }
    }
  }
  local_.delassus.rows = local_.delassus.columns = rows;
  update(problem);
}

void CondensedProblem::update(const ContactProblem& problem) {
  load_ = Eigen::Map<const VectorXd>(problem.load.data(), static_cast<Index>(problem.load.size()));
  local_.friction = problem.friction;
  local_.expert.row_blocks = problem.expert.row_blocks;
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

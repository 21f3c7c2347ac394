/// @file imbalance.cpp
/// The relative imbalance of the bodies of a problem.
#include "host/contact/problem/imbalance.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "host/contact/problem/measure.hpp"

namespace tetwarp {

void add_product(const SparseMatrix& matrix, std::span<const double> x, std::vector<double>& sum) {
  for (std::size_t r = 0; r < sum.size(); ++r) {
    const auto end = static_cast<std::size_t>(matrix.row_start[r + 1]);
    for (auto e = static_cast<std::size_t>(matrix.row_start[r]); e < end; ++e) {
      sum[r] += matrix.value[e] * x[static_cast<std::size_t>(matrix.column[e])];
    }
  }
}

double imbalance(const ContactProblem& problem,
                 std::span<const double> impulse,
                 std::span<const double> body_velocity) {
  if (problem.is_local()) return 0;
  std::vector<double> push(problem.load.size(), 0.0), product(problem.load.size(), 0.0);
  const SparseMatrix& jacobian = problem.jacobian;
  for (std::size_t row = 0; row < impulse.size(); ++row) {
    const auto end = static_cast<std::size_t>(jacobian.row_start[row + 1]);
    for (auto e = static_cast<std::size_t>(jacobian.row_start[row]); e < end; ++e) {
      push[static_cast<std::size_t>(jacobian.column[e])] += jacobian.value[e] * impulse[row];
    }
  }
  add_product(problem.system, body_velocity, product);
  double square = 0, push_square = 0, load_square = 0;
  for (std::size_t dof = 0; dof < product.size(); ++dof) {
    const double left = product[dof] - push[dof] - problem.load[dof];
    square += left * left;
    push_square += push[dof] * push[dof];
    load_square += problem.load[dof] * problem.load[dof];
  }
  return relative_error(std::sqrt(square), std::sqrt(std::max(push_square, load_square)));
}

}  // namespace tetwarp

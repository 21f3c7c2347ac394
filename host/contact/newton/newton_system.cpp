/// @file newton_system.cpp
/// Assembles and factorizes the equations, and counts what that costs.
#include "host/contact/newton/newton_system.hpp"

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <cstddef>
#include <vector>

#include "host/contact/problem/matrix.hpp"

namespace tetwarp {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::VectorXd;
using Matrix = Eigen::SparseMatrix<double>;

namespace {
/// With fewer unknowns a dense factorization is faster than a sparse one.
constexpr Index dense_limit = 300;

/// A block diagonal matrix.
Matrix make_block_diagonal(const std::vector<Matrix3d>& blocks) {
  const auto size = 3 * static_cast<Index>(blocks.size());
  Matrix matrix(size, size);
  matrix.reserve(Eigen::VectorXi::Constant(size, 3));
  for (std::size_t c = 0; c < blocks.size(); ++c) {
    const Index first = 3 * static_cast<Index>(c);
    for (Index column = 0; column < 3; ++column) {
      for (Index row = 0; row < 3; ++row) {
        matrix.insert(first + row, first + column) = blocks[c](row, column);
      }
    }
  }
  matrix.makeCompressed();
  return matrix;
}

/// Product of a block diagonal matrix and a vector.
VectorXd product(const std::vector<Matrix3d>& blocks, const VectorXd& x) {
  VectorXd result(x.size());
  for (std::size_t c = 0; c < blocks.size(); ++c) {
    const Index row = 3 * static_cast<Index>(c);
    result.segment<3>(row) = blocks[c] * x.segment<3>(row);
  }
  return result;
}
}  // namespace

NewtonSystem::NewtonSystem(const ContactProblem& problem, const Delassus& delassus)
    : delassus_(delassus), is_local_(problem.is_local()) {
  if (is_local_) {
    delassus_matrix_ = make_eigen(problem.delassus);
    if (delassus_matrix_.rows() < dense_limit) dense_delassus_ = delassus_matrix_;
    return;
  }
  jacobian_ = make_eigen(problem.jacobian);
  assembly_ = ContactAssembly(make_eigen(problem.system), jacobian_);
}

void NewtonSystem::keep(const std::vector<MapDerivative>& derivatives) {
  by_impulse_.clear();
  by_velocity_.clear();
  for (const MapDerivative& derivative : derivatives) {
    by_impulse_.push_back(derivative.by_impulse);
    by_velocity_.push_back(derivative.by_velocity);
  }
}

/// E + F B of few contacts in local form.
Eigen::MatrixXd NewtonSystem::dense_sum() const {
  Eigen::MatrixXd sum(dense_delassus_.rows(), dense_delassus_.cols());
  for (std::size_t c = 0; c < by_impulse_.size(); ++c) {
    const Index row = 3 * static_cast<Index>(c);
    sum.middleRows<3>(row).noalias() = by_velocity_[c] * dense_delassus_.middleRows<3>(row);
    sum.block<3, 3>(row, row) += by_impulse_[c];
  }
  return sum;
}

/// E + F B, or A + J^T E^-1 F J.
const Matrix& NewtonSystem::assemble() {
  if (is_local_) {
    local_sum_ =
        make_block_diagonal(by_impulse_) + make_block_diagonal(by_velocity_) * delassus_matrix_;
    return local_sum_;
  }
  impulse_inverse_.clear();
  response_.clear();
  for (std::size_t c = 0; c < by_impulse_.size(); ++c) {
    impulse_inverse_.push_back(by_impulse_[c].inverse());
    response_.push_back(impulse_inverse_[c] * by_velocity_[c]);
  }
  return assembly_.sum(response_);
}

bool NewtonSystem::factorize(const std::vector<MapDerivative>& derivatives) {
  keep(derivatives);
  const Index size = is_local_ ? delassus_matrix_.rows() : jacobian_.cols();
  factor_ = size < dense_limit ? Factor::dense : Factor::general;
  if (factor_ == Factor::dense) {
    is_local_ ? dense_factor_.compute(dense_sum()) : dense_factor_.compute(assemble());
    return dense_factor_.matrixLU().diagonal().array().isFinite().all() &&
           (dense_factor_.matrixLU().diagonal().array() != 0).all();
  }
  const Matrix& matrix = assemble();
  if (!has_order_) sparse_factor_.analyzePattern(matrix);
  has_order_ = true;
  sparse_factor_.factorize(matrix);
  return sparse_factor_.info() == Eigen::Success;
}

bool NewtonSystem::factorize_symmetric(const std::vector<MapDerivative>& derivatives) {
  if (is_local_) return factorize(derivatives);
  keep(derivatives);
  const Matrix& matrix = assemble();
  factor_ = Factor::symmetric;
  if (!has_symmetric_order_) symmetric_factor_.analyzePattern(matrix);
  has_symmetric_order_ = true;
  symmetric_factor_.factorize(matrix);
  return symmetric_factor_.info() == Eigen::Success;
}

NewtonCost newton_cost(const ContactProblem& problem, double limit) {
  // 8 bytes for the number and 4 for its row; growing arrays are copied, and partial pivoting fills
  // more than the symmetric order.
  constexpr double bytes_per_entry = 12 * 2;
  const auto unknowns =
      static_cast<double>(problem.is_local() ? 3 * problem.contact_count() : problem.dof_count());
  const double dense = 2 * bytes_per_entry * unknowns * unknowns / 2;
  Matrix pattern = make_eigen(problem.is_local() ? problem.delassus : problem.system);
  if (!problem.is_local()) {
    const Matrix jacobian = make_eigen(problem.jacobian).cwiseAbs();
    pattern = Matrix(pattern.cwiseAbs()) + Matrix(jacobian.transpose()) * jacobian;
  }
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(pattern, order);
  const Matrix symmetric = pattern + Matrix(pattern.transpose());
  Matrix sorted;
  sorted = symmetric.twistedBy(order.inverse());
  // Row k of the factor has an entry for every column on the way from the entries of row k up the
  // elimination tree to k.
  std::vector<Index> parent(static_cast<std::size_t>(sorted.cols()), -1);
  std::vector<Index> seen_by(parent.size(), -1);
  std::vector<double> column_entries(parent.size(), 0.0);  // of L below the diagonal
  double entries = 0;
  for (Index k = 0; k < sorted.cols(); ++k) {
    seen_by[static_cast<std::size_t>(k)] = k;
    for (Matrix::InnerIterator entry(sorted, k); entry && entry.row() < k; ++entry) {
      for (Index i = entry.row(); seen_by[static_cast<std::size_t>(i)] != k;
           i = parent[static_cast<std::size_t>(i)]) {
        if (parent[static_cast<std::size_t>(i)] < 0) parent[static_cast<std::size_t>(i)] = k;
        seen_by[static_cast<std::size_t>(i)] = k;
        ++column_entries[static_cast<std::size_t>(i)];
        ++entries;
      }
    }
    if (2 * entries * bytes_per_entry > limit && dense > limit) break;
  }
  NewtonCost cost{std::min(dense, 2 * entries * bytes_per_entry), 0};
  for (const double below : column_entries) cost.flops += (below + 1) * (below + 1);
  return cost;
}

VectorXd NewtonSystem::solve(const VectorXd& right_side) {
  VectorXd x = solve_once(right_side);
  const int refinements = factor_ == Factor::symmetric ? 2 : 1;
  for (int step = 0; step < refinements; ++step) {
    x += solve_once(right_side - product(by_impulse_, x) -
                    product(by_velocity_, delassus_.velocity_change(x)));
  }
  return x;
}

VectorXd NewtonSystem::solve_once(const VectorXd& right_side) {
  if (is_local_) return solve_factorized(right_side);
  const VectorXd pushed = product(impulse_inverse_, right_side);
  const VectorXd y = solve_factorized(jacobian_.transpose() * pushed);
  return product(impulse_inverse_, right_side - product(by_velocity_, jacobian_ * y));
}

VectorXd NewtonSystem::solve_factorized(const VectorXd& right_side) {
  switch (factor_) {
    case Factor::dense:
      return dense_factor_.solve(right_side);
    case Factor::symmetric:
      return symmetric_factor_.solve(right_side);
    case Factor::general:
      break;
  }
  return sparse_factor_.solve(right_side);
}

}  // namespace tetwarp

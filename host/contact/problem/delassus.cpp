/// @file delassus.cpp
/// Products by a factorization of A, or by a stored Delassus matrix.
#include "host/contact/problem/delassus.hpp"

#include <algorithm>
#include <cstddef>

#include "host/contact/problem/matrix.hpp"
#include "host/contact/problem/row_blocks.hpp"

namespace tetwarp {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Matrix = Eigen::SparseMatrix<double>;

namespace {
VectorXd make_vector(const std::vector<double>& values) {
  return Eigen::Map<const VectorXd>(values.data(), static_cast<Index>(values.size()));
}

/// Diagonal blocks of J A^-1 J^T, one contact at a time: J_c A^-1 J_c^T = Y^T D^-1 Y with Y = L^-1
/// P J_c^T. Y is zero outside the ancestors of the contact's dofs in the elimination tree; only
/// those columns of L are visited.
class HalfSolve {
 public:
  explicit HalfSolve(const SystemFactor::Ldlt& factor)
      : lower_(factor.matrixL().nestedExpression()),
        diagonal_(factor.vectorD()),
        order_(factor.permutationP()),
        rows_(static_cast<std::size_t>(lower_.cols()), Vector3d::Zero()),
        is_reached_(rows_.size(), false) {}

  Matrix3d diagonal_block(const Matrix& transposed_jacobian, Index contact) {
    for (int row = 0; row < 3; ++row) {
      for (Matrix::InnerIterator entry(transposed_jacobian, 3 * contact + row); entry; ++entry) {
        const Index dof = order_.size() > 0 ? order_.indices()(entry.row()) : entry.row();
        rows_[static_cast<std::size_t>(dof)](row) += entry.value();
        reach(dof);
      }
    }
    std::sort(reached_.begin(), reached_.end());
    Matrix3d block = Matrix3d::Zero();
    for (const Index column : reached_) {
      Vector3d& y = rows_[static_cast<std::size_t>(column)];
      for (Matrix::InnerIterator entry(lower_, column); entry; ++entry) {
        rows_[static_cast<std::size_t>(entry.row())] -= entry.value() * y;
      }
      block += y * (y / diagonal_(column)).transpose();
      y.setZero();
      is_reached_[static_cast<std::size_t>(column)] = false;
    }
    reached_.clear();
    return block;
  }

 private:
  /// Adds a column and its ancestors to `reached_`. The parent is the first row below the diagonal.
  void reach(Index column) {
    while (!is_reached_[static_cast<std::size_t>(column)]) {
      is_reached_[static_cast<std::size_t>(column)] = true;
      reached_.push_back(column);
      const Matrix::InnerIterator parent(lower_, column);
      if (!parent) return;
      column = parent.row();
    }
  }

  const Matrix& lower_;  ///< L without its unit diagonal, rows of each column in increasing order
  const VectorXd diagonal_;
  const Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order_;
  std::vector<Vector3d> rows_;
  std::vector<bool> is_reached_;
  std::vector<Index> reached_;
};
}  // namespace

Delassus::Delassus(const ContactProblem& problem, double recovery_speed)
    : is_local_(problem.is_local()) {
  if (is_local_) {
    matrix_ = make_eigen(problem.delassus);
    free_velocity_ = make_vector(problem.free_velocity);
    return;
  }
  matrix_ = make_eigen(problem.system);
  // A problem without contacts may have an empty J.
  jacobian_.resize(matrix_.rows(), 0);
  if (!problem.jacobian.empty()) jacobian_ = make_eigen(problem.jacobian).transpose();
  load_ = make_vector(problem.load);
  offset_ = make_vector(problem.velocity_offset);
  for (Index row = 0; row < offset_.size(); row += 3) {
    if (!is_contact_block(problem, static_cast<std::size_t>(row / 3))) continue;
    offset_(row) = std::max(offset_(row), -recovery_speed);
  }
  factor_.factorize(matrix_);
  free_velocity_ = contact_velocity(factor_.solve(load_));
}

VectorXd Delassus::velocity_change(const VectorXd& impulse) const {
  if (is_local_) return matrix_ * impulse;
  return jacobian_.transpose() * factor_.solve(jacobian_ * impulse).eval();
}

double Delassus::magnitude(const VectorXd& impulse) const {
  const VectorXd sizes = impulse.cwiseAbs();
  if (is_local_) return sizes.dot(matrix_.cwiseAbs() * sizes);
  const VectorXd push = jacobian_.cwiseAbs() * sizes;
  return push.dot(factor_.solve(push));
}

VectorXd Delassus::body_velocity(const VectorXd& impulse) const {
  if (is_local_) return {};
  return factor_.solve(load_ + jacobian_ * impulse);
}

VectorXd Delassus::contact_velocity(const VectorXd& body_velocity) const {
  return jacobian_.transpose() * body_velocity + offset_;
}

std::vector<Matrix3d> Delassus::diagonal_blocks() const {
  const Index contacts = free_velocity_.size() / 3;
  std::vector<Matrix3d> blocks(static_cast<std::size_t>(contacts));
  if (is_local_) {
    for (Index c = 0; c < contacts; ++c) {
      blocks[static_cast<std::size_t>(c)] = Matrix3d(matrix_.block(3 * c, 3 * c, 3, 3));
    }
    return blocks;
  }
  HalfSolve half(factor_.ldlt());
  for (Index c = 0; c < contacts; ++c) {
    blocks[static_cast<std::size_t>(c)] = half.diagonal_block(jacobian_, c);
  }
  return blocks;
}

}  // namespace tetwarp

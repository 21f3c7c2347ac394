/// @file dense_bodies.cpp
/// Copies the numbers of a problem, and adds contact by contact.
#include "host/contact/newton/dense_bodies.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

#include "host/base/index_of.hpp"

namespace tetwarp {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

DenseBodies::DenseBodies(const ContactProblem& problem, double recovery_speed)
    : load_(Eigen::Map<const VectorXd>(problem.load.data(), std::ssize(problem.load))),
      system_(MatrixXd::Zero(problem.dof_count(), problem.dof_count())),
      contacts_(problem.friction.size()) {
  const SparseMatrix& system = problem.system;
  for (Index row = 0; row < system_.rows(); ++row) {
    for (auto e = system.row_start[index_of(row)]; e < system.row_start[index_of(row + 1)]; ++e) {
      system_(row, system.column[index_of(e)]) += system.value[index_of(e)];
    }
  }
  inverse_ = system_.llt().solve(MatrixXd::Identity(system_.rows(), system_.cols()));
  const SparseMatrix& jacobian = problem.jacobian;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    Contact& own = contacts_[c];
    own.offset = Eigen::Map<const Vector3d>(problem.velocity_offset.data() + 3 * c);
    own.offset(0) = std::max(own.offset(0), -recovery_speed);
    const auto begin = jacobian.row_start[3 * c], end = jacobian.row_start[3 * c + 3];
    own.dofs.assign(jacobian.column.begin() + begin, jacobian.column.begin() + end);
    std::ranges::sort(own.dofs);
    own.dofs.erase(std::unique(own.dofs.begin(), own.dofs.end()), own.dofs.end());
    own.jacobian.setZero(3, std::ssize(own.dofs));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t row = 3 * c + axis;
      for (auto e = jacobian.row_start[row]; e < jacobian.row_start[row + 1]; ++e) {
        const auto place = std::ranges::lower_bound(own.dofs, jacobian.column[index_of(e)]);
        own.jacobian(static_cast<Index>(axis), place - own.dofs.begin()) +=
            jacobian.value[index_of(e)];
      }
    }
  }
}

Matrix3d DenseBodies::diagonal_block(std::size_t contact) const {
  const Contact& own = contacts_[contact];
  return own.jacobian * inverse_(own.dofs, own.dofs) * own.jacobian.transpose();
}

Vector3d DenseBodies::contact_velocity(std::size_t contact, const VectorXd& velocity) const {
  const Contact& own = contacts_[contact];
  Vector3d u = own.offset;
  for (std::size_t k = 0; k < own.dofs.size(); ++k) {
    u += velocity(own.dofs[k]) * own.jacobian.col(static_cast<Index>(k));
  }
  return u;
}

void DenseBodies::add_push(std::size_t contact, const Vector3d& impulse, VectorXd& sum) const {
  const Contact& own = contacts_[contact];
  for (std::size_t k = 0; k < own.dofs.size(); ++k) {
    sum(own.dofs[k]) += own.jacobian.col(static_cast<Index>(k)).dot(impulse);
  }
}

void DenseBodies::add_push_size(std::size_t contact, const Vector3d& impulse, VectorXd& sum) const {
  const Contact& own = contacts_[contact];
  for (std::size_t k = 0; k < own.dofs.size(); ++k) {
    sum(own.dofs[k]) += own.jacobian.col(static_cast<Index>(k)).cwiseAbs().dot(impulse.cwiseAbs());
  }
}

void DenseBodies::add_response(std::size_t contact, const Matrix3d& response, MatrixXd& sum) const {
  const Contact& own = contacts_[contact];
  for (std::size_t column = 0; column < own.dofs.size(); ++column) {
    const Vector3d moved = response * own.jacobian.col(static_cast<Index>(column));
    for (std::size_t row = column; row < own.dofs.size(); ++row) {
      sum(own.dofs[row], own.dofs[column]) += own.jacobian.col(static_cast<Index>(row)).dot(moved);
    }
  }
}

}  // namespace tetwarp

/// @file delassus.hpp
/// What impulses do to the velocities at the contacts, with the whole system factorized.
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <vector>

#include <tetwarp/contact_problem.hpp>

namespace tetwarp {

/// B = J A^-1 J^T of a global problem, never formed, or B = W of a local one.
///
/// Cost of the constructor: one sparse Cholesky factorization of A.
class Delassus {
 public:
  /// @param recovery_speed  penetration is undone at most this fast [m/s]: limits -w_n in global
  ///                        form; a local problem does not tell w_n from the rest of q
  /// @pre check_problem(problem) has passed
  /// @throws ContactProblemError  when A as a whole is not positive definite
  Delassus(const ContactProblem& problem, double recovery_speed);

  /// B r, [3 contacts], m/s.
  Eigen::VectorXd velocity_change(const Eigen::VectorXd& impulse) const;

  /// q: the velocity [m/s] of the contacts without impulses, offset included.
  const Eigen::VectorXd& free_velocity() const { return free_velocity_; }

  /// A^-1 (b + J^T r), [dofs]; empty in local form.
  Eigen::VectorXd body_velocity(const Eigen::VectorXd& impulse) const;

  /// J v + w, [3 contacts].
  /// @pre global form
  Eigen::VectorXd contact_velocity(const Eigen::VectorXd& body_velocity) const;

  /// B_cc of every contact, [contacts], 1/kg. Cost in global form: per contact the part of the
  /// factor that its dofs reach, which for bodies of their own is their block.
  std::vector<Eigen::Matrix3d> diagonal_blocks() const;

 private:
  Eigen::SparseMatrix<double> matrix_;    ///< A, or W
  Eigen::SparseMatrix<double> jacobian_;  ///< J^T: the dofs of a row of J are a column
  Eigen::VectorXd load_;
  Eigen::VectorXd offset_;
  Eigen::VectorXd free_velocity_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
  bool is_local_ = false;
};

}  // namespace tetwarp

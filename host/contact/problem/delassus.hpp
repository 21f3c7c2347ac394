/// @file delassus.hpp
/// Products with the Delassus matrix, which maps impulses to velocity changes at the contacts.
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include <tetwarp/contact_problem.hpp>

#include "host/contact/problem/system_factor.hpp"

namespace tetwarp {

/// B = J A^-1 J^T of a problem in global form, applied through a factorization of A and never
/// stored, or B = W of one in local form.
///
/// Cost of the constructor: one sparse Cholesky factorization of A.
class Delassus {
 public:
  /// @param recovery_speed  existing penetration is undone at most this fast [m/s]: limits -w_n in
  ///                        global form; no effect in local form, where w is a part of q
  /// @pre check_problem(problem) has passed
  /// @throws ContactProblemError  A as a whole is not positive definite
  Delassus(const ContactProblem& problem, double recovery_speed);

  /// B r, [3 contacts], m/s.
  Eigen::VectorXd velocity_change(const Eigen::VectorXd& impulse) const;

  /// |r| . |B| |r| [J], the sum of what cancels in r . B r; its rounding error is 2^-49 times this.
  /// Global form: g . A^-1 g with g = |J|^T |r|, at least that of each body by itself.
  double magnitude(const Eigen::VectorXd& impulse) const;

  /// q: the relative velocities [m/s] without impulses, offset included, [3 contacts].
  const Eigen::VectorXd& free_velocity() const { return free_velocity_; }

  /// A^-1 (b + J^T r), [dofs]; empty in local form.
  Eigen::VectorXd body_velocity(const Eigen::VectorXd& impulse) const;

  /// J v + w, [3 contacts].
  /// @pre global form
  Eigen::VectorXd contact_velocity(const Eigen::VectorXd& body_velocity) const;

  /// B_cc of every contact, [contacts], 1/kg. Cost in global form: per contact the columns of the
  /// factor that its dofs reach in the elimination tree; for rigid bodies, their own blocks.
  std::vector<Eigen::Matrix3d> diagonal_blocks() const;

 private:
  Eigen::SparseMatrix<double> matrix_;    ///< A, or W
  Eigen::SparseMatrix<double> jacobian_;  ///< J^T, by columns
  Eigen::VectorXd load_;
  Eigen::VectorXd offset_;
  Eigen::VectorXd free_velocity_;
  SystemFactor factor_;  ///< of A; not used in local form
  bool is_local_ = false;
};

}  // namespace tetwarp

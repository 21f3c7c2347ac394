/// @file condense.hpp
/// A coupled problem in local form: its Delassus matrix, by a sparse Cholesky factorization of A.
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include <tetwarp/contact_problem.hpp>

#include "host/contact/problem/budget.hpp"
#include "host/contact/problem/system_factor.hpp"

namespace tetwarp {

class CondensedProblem {
 public:
  /// Cost: a factorization of A, 3 solves per contact, (3 contacts)^2 numbers. A^-1 J^T is computed
  /// 48 columns at a time and never stored as a whole.
  /// @param problem  in global form
  /// @param budget   read during the constructor only; null: no limits
  /// @throws ContactProblemError  A is not positive definite
  /// @throws BudgetOver           the budget was used up before the matrix was complete
  explicit CondensedProblem(const ContactProblem& problem, SolveBudget* budget = nullptr);

  /// Takes load, offsets, friction, adhesion and guess from another problem with the same A and J.
  /// The numbers have the same bits as those of a new condensation. Cost: one solve.
  void update(const ContactProblem& problem);

  /// The contacts in local form, with W = J A^-1 J^T as dense blocks (see has_dense_blocks()) and
  /// q = J A^-1 b + w.
  const ContactProblem& local() const { return local_; }

  /// v = A^-1 (b + J^T r), [dofs], m/s.
  /// @param impulse  r, [3 contacts], N s
  std::vector<double> body_velocity(const std::vector<double>& impulse) const;

 private:
  SystemFactor factor_;
  Eigen::SparseMatrix<double> jacobian_;
  Eigen::VectorXd load_;
  ContactProblem local_;
};

}  // namespace tetwarp

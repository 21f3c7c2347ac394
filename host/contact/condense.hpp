/// @file condense.hpp
/// A coupled problem in local form: its Delassus matrix, by a sparse Cholesky factorization.
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include <tetwarp/contact_problem.hpp>

#include "host/contact/problem/system_factor.hpp"

namespace tetwarp {

class CondensedProblem {
 public:
  /// Cost: a factorization of A, 3 solves per contact, (3 contacts)^2 numbers. The solves go in
  /// runs, so that A^-1 J^T is never there as a whole.
  /// @param problem  global form
  /// @throws ContactProblemError  A is not positive definite
  explicit CondensedProblem(const ContactProblem& problem);

  /// Takes all but A and J from another problem, which has the same; the bits are those of a new
  /// condensation. Cost: one solve.
  void update(const ContactProblem& problem);

  /// W = J A^-1 J^T dense, q = J A^-1 b + w; the rest as in the problem.
  const ContactProblem& local() const { return local_; }

  /// v = A^-1 (b + J^T r), [dofs].
  std::vector<double> body_velocity(const std::vector<double>& impulse) const;

 private:
  SystemFactor factor_;
  Eigen::SparseMatrix<double> jacobian_;
  Eigen::VectorXd load_;
  ContactProblem local_;
};

}  // namespace tetwarp

/// @file system_factor.hpp
/// Sparse Cholesky factorization of the system A of a contact problem.
#pragma once
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include <tetwarp/contact_problem.hpp>

namespace tetwarp {

/// A = P^T L D L^T P with a permutation P that keeps L sparse.
class SystemFactor {
 public:
  using Ldlt = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;

  /// @throws ContactProblemError  A is not positive definite
  void factorize(const Eigen::SparseMatrix<double>& system) {
    ldlt_.compute(system);
    if (ldlt_.info() == Eigen::Success && (ldlt_.vectorD().array() > 0).all()) return;
    throw ContactProblemError(
        "system",
        ": not positive definite, although its diagonal blocks are; give mass "
        "to every dof, and no coupling stronger than that of a mass or a "
        "stiffness matrix");
  }

  /// A^-1 times a vector or a matrix.
  /// @pre factorize() has succeeded
  template <class RightSide>
  auto solve(const Eigen::MatrixBase<RightSide>& right_side) const {
    return ldlt_.solve(right_side);
  }

  const Ldlt& ldlt() const { return ldlt_; }

 private:
  Ldlt ldlt_;
};

}  // namespace tetwarp

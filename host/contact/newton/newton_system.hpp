/// @file newton_system.hpp
/// The linear equations of one Newton step on the impulses.
#pragma once
#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <vector>

#include <tetwarp/contact_problem.hpp>

#include "host/contact/newton/contact_assembly.hpp"
#include "host/contact/newton/natural_map.hpp"
#include "host/contact/problem/delassus.hpp"

namespace tetwarp {

/// Solves (E + F B) x = c, with E and F block diagonal and B the Delassus matrix.
///
/// Local form: these equations. Global form: equations for the velocities y = A^-1 J^T x,
///
///     (A + J^T E^-1 F J) y = J^T E^-1 c,   x = E^-1 (c - F J y)
///
/// whose matrix has entries only where A has and between bodies in contact, and about half as many
/// unknowns where bodies have many contacts.
class NewtonSystem {
 public:
  /// @param delassus  of the same problem; must be valid as long as this object
  NewtonSystem(const ContactProblem& problem, const Delassus& delassus);

  /// @param derivatives  E and F, [contacts]; global form: E invertible
  /// @return false  if the equations are numerically singular
  bool factorize(const std::vector<MapDerivative>& derivatives);

  /// As factorize(), by a sparse Cholesky factorization in global form.
  /// @pre every E^-1 F is symmetric and positive semidefinite
  bool factorize_symmetric(const std::vector<MapDerivative>& derivatives);

  /// x, after iterative refinement: two steps with factorize_symmetric(), else one.
  /// @pre the last factorization has returned true
  Eigen::VectorXd solve(const Eigen::VectorXd& right_side);

 private:
  enum class Factor { dense, general, symmetric };

  void keep(const std::vector<MapDerivative>& derivatives);
  Eigen::MatrixXd dense_sum() const;
  const Eigen::SparseMatrix<double>& assemble();
  Eigen::VectorXd solve_once(const Eigen::VectorXd& right_side);
  Eigen::VectorXd solve_factorized(const Eigen::VectorXd& right_side);

  const Delassus& delassus_;
  bool is_local_;
  Eigen::SparseMatrix<double> delassus_matrix_;   ///< W, local form
  Eigen::MatrixXd dense_delassus_;                ///< W of few contacts, local form
  Eigen::SparseMatrix<double> local_sum_;         ///< E + F W, local form
  Eigen::SparseMatrix<double> jacobian_;          ///< J, global form
  ContactAssembly assembly_;                      ///< global form
  std::vector<Eigen::Matrix3d> by_impulse_;       ///< E
  std::vector<Eigen::Matrix3d> by_velocity_;      ///< F
  std::vector<Eigen::Matrix3d> impulse_inverse_;  ///< E^-1, global form
  std::vector<Eigen::Matrix3d> response_;         ///< E^-1 F, global form
  Factor factor_ = Factor::general;               ///< the last one
  Eigen::PartialPivLU<Eigen::MatrixXd> dense_factor_;
  Eigen::SparseLU<Eigen::SparseMatrix<double>> sparse_factor_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> symmetric_factor_;
  bool has_order_ = false;            ///< of sparse_factor_; the pattern does not change
  bool has_symmetric_order_ = false;  ///< of symmetric_factor_
};

/// Estimated cost of one factorization of a NewtonSystem.
struct NewtonCost {
  double bytes = 0;  ///< of the factors
  double flops = 0;  ///< of a symmetric elimination; pivoting takes a small multiple
};

/// Counts the fill of a symmetric elimination of the pattern in minimum-degree order; the memory
/// includes a factor for pivoting.
/// @param limit  of the memory [bytes]: counting ends when the estimate exceeds it
NewtonCost newton_cost(const ContactProblem& problem, double limit);

}  // namespace tetwarp

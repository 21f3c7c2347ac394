/// @file dense.hpp
/// A contact problem as dense matrices, and its residual computed directly from the laws. Part of
/// back end `reference`, which shares no code with the kernels: the tests compare them with it.
#pragma once
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <limits>
#include <vector>

#include <tetwarp/contact.hpp>

namespace tetwarp::reference {

/// u = B r + q, v = v_free + V r and lambda = lambda_free + L r; rows are ordered by contact:
/// normal, tangent 1, tangent 2, then three rows per entry of rolling friction: about the normal,
/// tangent 1, tangent 2. Bilateral rows are eliminated: all of these hold with them.
struct DenseContacts {
  Eigen::MatrixXd delassus;            ///< B, [rows][rows], 1/kg
  Eigen::VectorXd free_velocity;       ///< q, m/s, offset included
  Eigen::VectorXd stiffness;           ///< diagonal of K, kg
  Eigen::VectorXd offset;              ///< o: stored gaps over dt, the normal one less w_n, m/s
  Eigen::VectorXd friction;            ///< mu along tangent 1, [contacts]
  Eigen::VectorXd second_friction;     ///< mu along tangent 2, [contacts]
  Eigen::MatrixXd body_change;         ///< V, [dofs][rows]; A^-1 J^T without bilateral rows
  Eigen::VectorXd free_body_velocity;  ///< v_free, [dofs]; A^-1 b without bilateral rows
  Eigen::MatrixXd bilateral_change;    ///< L, [bilateral rows][rows]
  Eigen::VectorXd free_bilateral;      ///< lambda_free, [bilateral rows]

  /// Rolling friction of one contact.
  struct Rolling {
    Eigen::Index contact;
    double rolling, torsion;  ///< m
  };
  std::vector<Rolling> rolling;

  Eigen::Index contact_count() const { return friction.size(); }
  /// First row of an entry of `rolling`.
  Eigen::Index rolling_row(Eigen::Index entry) const { return 3 * (contact_count() + entry); }
  Eigen::VectorXd velocity(const Eigen::VectorXd& impulse) const {
    return delassus * impulse + free_velocity;
  }
};

/// @param recovery_speed  upper limit of -w_n in global form [m/s]
/// @pre check_problem(problem) has passed
/// @throws ContactProblemError  A as a whole is not positive definite
DenseContacts make_dense(const ContactProblem& problem,
                         double recovery_speed = std::numeric_limits<double>::infinity());

/// ContactMeasure::eta: the energy-weighted natural residual, relative to that without impulses; 0
/// exactly at a solution; infinity where anything is not finite. r . B r counts in the scale only
/// as far as it exceeds its own rounding error, 2^-49 |r| . |B| |r|. Of contacts with a friction
/// ellipse, the residual is that in the coordinates r_a mu / mu_a and u_a mu_a / mu, in which it is
/// a disc.
double eta_of(const DenseContacts& contacts,
              const Eigen::VectorXd& impulse,
              const ContactOptions& options);

}  // namespace tetwarp::reference

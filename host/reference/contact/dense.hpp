/// @file dense.hpp
/// A contact problem as dense matrices, and its residual computed directly from the laws. Part of
/// back end `reference`, which shares no code with the kernels: the tests compare them with it.
#pragma once
#include <Eigen/Core>
#include <limits>
#include <vector>

#include <tetwarp/contact.hpp>

namespace tetwarp::reference {

/// u = B r + q and v = v_free + V r; rows are ordered by contact: normal, tangent 1, tangent 2.
struct DenseContacts {
  Eigen::MatrixXd delassus;            ///< B, [3 contacts][3 contacts], 1/kg
  Eigen::VectorXd free_velocity;       ///< q, m/s, offset included
  Eigen::VectorXd stiffness;           ///< diagonal of K, kg
  Eigen::VectorXd offset;              ///< o: stored gaps over dt, the normal one less w_n, m/s
  Eigen::VectorXd friction;            ///< mu, [contacts]
  Eigen::MatrixXd body_change;         ///< V = A^-1 J^T, [dofs][3 contacts]; no rows in local form
  Eigen::VectorXd free_body_velocity;  ///< A^-1 b, [dofs]

  Eigen::Index contact_count() const { return friction.size(); }
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
/// as far as it exceeds its own rounding error, 2^-49 |r| . |B| |r|.
double eta_of(const DenseContacts& contacts,
              const Eigen::VectorXd& impulse,
              const ContactOptions& options);

/// Impulses of the solutions of a pyramid or frictionless problem, one for each velocity. All
/// combinations of open, sticking and sliding contacts are tried: in each the laws are a linear
/// system, whose solution is kept if it satisfies all laws.
/// @pre mode_count(contacts, options) is finite; the cost is proportional to it
std::vector<Eigen::VectorXd> enumerate_impulses(const DenseContacts& contacts,
                                                const ContactOptions& options);

/// Linear systems that enumerate_impulses() solves; infinity for laws that are not piecewise
/// linear.
double mode_count(const DenseContacts& contacts, const ContactOptions& options);

/// Whether impulses exist that make every u_n >= 0.
bool is_feasible(const DenseContacts& contacts);

}  // namespace tetwarp::reference

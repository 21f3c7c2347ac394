/// @file dense_bodies.hpp
/// DenseBodies: the bodies of a small contact problem, in dense matrices.
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include <tetwarp/contact_problem.hpp>

namespace tetwarp {

/// A, its inverse, and J of each contact without the columns of zeros.
///
/// Memory: two matrices of dofs x dofs.
class DenseBodies {
 public:
  /// @param recovery_speed  limit of -w_n [m/s], as of Delassus
  /// @pre check_problem(problem) has passed; global form
  DenseBodies(const ContactProblem& problem, double recovery_speed);

  const Eigen::VectorXd& load() const { return load_; }      ///< b, [dofs], N s
  const Eigen::MatrixXd& system() const { return system_; }  ///< A, [dofs][dofs]
  /// x -> A^-1 x, [dofs].
  Eigen::VectorXd solve(const Eigen::VectorXd& x) const { return inverse_ * x; }
  /// B of a contact, the diagonal block of J A^-1 J^T [1/kg].
  Eigen::Matrix3d diagonal_block(std::size_t contact) const;

  /// J v + w of a contact [m/s]. @param velocity  v, [dofs]
  Eigen::Vector3d contact_velocity(std::size_t contact, const Eigen::VectorXd& velocity) const;
  /// sum += J^T r of a contact. @param impulse  r [N s]; sum  [dofs]
  void add_push(std::size_t contact, const Eigen::Vector3d& impulse, Eigen::VectorXd& sum) const;
  /// sum += |J|^T |r| of a contact.
  void add_push_size(std::size_t contact,
                     const Eigen::Vector3d& impulse,
                     Eigen::VectorXd& sum) const;
  /// Adds J^T G J of a contact to the lower triangle of a matrix. @param response  G, symmetric
  void add_response(std::size_t contact,
                    const Eigen::Matrix3d& response,
                    Eigen::MatrixXd& sum) const;

 private:
  struct Contact {
    std::vector<Eigen::Index> dofs;  ///< that it moves, rising
    Eigen::Matrix3Xd jacobian;       ///< J at these
    Eigen::Vector3d offset;          ///< w [m/s]
  };

  Eigen::VectorXd load_;
  Eigen::MatrixXd system_, inverse_;
  std::vector<Contact> contacts_;
};

}  // namespace tetwarp

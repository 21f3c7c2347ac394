/// @file local.hpp
/// The problem of one contact, all other impulses constant. Part of back end `reference`.
#pragma once
#include <Eigen/Core>

#include <tetwarp/contact.hpp>

namespace tetwarp::reference {

/// One contact: u = B r + u0, where u0 is its velocity from all other impulses.
struct LocalContact {
  Eigen::Matrix3d delassus;    ///< B, 1/kg
  Eigen::Vector3d stiffness;   ///< diagonal of K, kg
  Eigen::Vector3d offset;      ///< o, m/s
  double friction = 0;         ///< mu along tangent 1
  double second_friction = 0;  ///< mu along tangent 2
};

/// Impulse that obeys the laws with the cone: open, sticking, or sliding by bisection to rounding.
/// With two friction coefficients, friction is the point of the ellipse of most dissipation.
/// @param free  u0, m/s
Eigen::Vector3d solve_cone(const LocalContact& contact,
                           const Eigen::Vector3d& free,
                           const ContactOptions& options);

/// Impulse after one Gauss-Seidel update of normal, tangent 1 and tangent 2 in this order, each by
/// its own law with the other two constant. Repeated updates converge to the solution with the
/// pyramid.
/// @param impulse   before the update
/// @param velocity  u with that impulse, m/s
Eigen::Vector3d update_pyramid(const LocalContact& contact,
                               Eigen::Vector3d impulse,
                               Eigen::Vector3d velocity,
                               const ContactOptions& options);

/// Angular impulses of one contact against spinning and rolling: torsion first, then rolling, by
/// bisection to rounding.
/// @param delassus  B of the three rows
/// @param impulse   before the update
/// @param velocity  with that impulse, rad/s
/// @param torsion   bound of the first impulse
/// @param rolling   bound of the length of the other two
Eigen::Vector3d update_rolling(const Eigen::Matrix3d& delassus,
                               Eigen::Vector3d impulse,
                               Eigen::Vector3d velocity,
                               double torsion,
                               double rolling);

}  // namespace tetwarp::reference

/// @file local.hpp
/// One contact solved for its own impulse, all others held. Part of back end `reference`.
#pragma once
#include <Eigen/Core>

#include <tetwarp/contact.hpp>

namespace tetwarp::reference {

/// One contact as its neighbors leave it: u = B r + u0.
struct LocalContact {
  Eigen::Matrix3d delassus;   ///< B, 1/kg
  Eigen::Vector3d stiffness;  ///< diagonal of K, kg
  Eigen::Vector3d offset;     ///< o, m/s
  double friction = 0;        ///< mu
};

/// Impulse that obeys the laws with the cone exactly: open, sticking or, by bisection, sliding.
/// @param free  u0, m/s
Eigen::Vector3d solve_cone(const LocalContact& contact,
                           const Eigen::Vector3d& free,
                           const ContactOptions& options);

/// Impulse after one update of normal, tangent 1 and tangent 2 in this order, each by its own law
/// with the other two as they stand: a step towards the solution with the pyramid.
/// @param impulse   before the update
/// @param velocity  u with that impulse, m/s
Eigen::Vector3d update_pyramid(const LocalContact& contact,
                               Eigen::Vector3d impulse,
                               Eigen::Vector3d velocity,
                               const ContactOptions& options);

}  // namespace tetwarp::reference

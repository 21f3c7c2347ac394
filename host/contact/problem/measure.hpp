/// @file measure.hpp
/// How far impulses and velocities are from solving a problem, contact by contact, in float64.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include <tetwarp/contact.hpp>

namespace tetwarp {

/// All that the measures know of one contact.
struct MeasuredContact {
  Eigen::Matrix3d diagonal_block;  ///< of the Delassus matrix [1/kg]
  Eigen::Vector3d stiffness;       ///< K: kappa_n, kappa_t, kappa_t [kg]
  Eigen::Vector3d offset;          ///< o: 0 and the stored tangential gap over dt [m/s]
  double friction = 0;
};

/// The contacts of a problem, their diagonal blocks still zero.
std::vector<MeasuredContact> measured_contacts(const ContactProblem& problem);

/// Energy [J] of the natural residual of one contact: 0 exactly where the contact laws hold.
///
/// With nu = r + K (u + o), rho_n = 1 / B_nn + kappa_n, rho_t = 1 / (largest eigenvalue of B_tt) +
/// kappa_t, and P the projection on the disc or square of radius R:
///
///     e_n = min(nu_n, rho_n u_n),   e_t = nu_t - P(nu_t - rho_t u_t)
///     energy = e_n^2 / rho_n + |e_t|^2 / rho_t
double natural_energy(const MeasuredContact& contact,
                      const Eigen::Vector3d& impulse,
                      const Eigen::Vector3d& velocity,
                      FrictionLaw law,
                      AdhesionRule rule);

/// Squared natural-map error of one contact as FCLIB weighs it, without units made equal:
/// |nu - P(nu - u - mu |u_t| n)|^2 with P the projection on Coulomb's cone, which is FCLIB's own
/// measure where nothing adheres. The pyramid and the restrictive rule have no such cone: there it
/// is the energy above with rho = 1.
double fclib_square(const MeasuredContact& contact,
                    const Eigen::Vector3d& impulse,
                    const Eigen::Vector3d& velocity,
                    FrictionLaw law,
                    AdhesionRule rule);

}  // namespace tetwarp

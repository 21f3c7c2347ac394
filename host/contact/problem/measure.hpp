/// @file measure.hpp
/// How far impulses and velocities are from satisfying the laws of contact, contact by contact, in
/// float64; and the terms of the natural map, which Newton's method uses too.
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <tetwarp/contact.hpp>

#include "kernels/contact/contact_law.hpp"

namespace tetwarp {

/// The constants in the laws of one contact.
struct MeasuredContact {
  Eigen::Matrix3d diagonal_block;  ///< B, of the Delassus matrix [1/kg]
  Eigen::Vector3d stiffness;       ///< diagonal of K: kappa_n, kappa_t, kappa_t [kg]
  Eigen::Vector3d offset;          ///< o: 0 and the stored tangential gap over dt [m/s]
  double friction = 0;

  // Of blocks of rows that are no contacts; see kernels/contact/row_law.hpp.
  ContactKind kind = ContactKind::coulomb;  ///< `coulomb` of every contact
  std::int64_t contact = -1;                ///< of a rolling block: its contact
  double torsion = 0;                       ///< [m]
  double push = 0;  ///< normal impulse of `contact`, at least 0: the caller sets it
};

/// The contacts of a problem, with diagonal blocks of zeros: the caller sets them.
std::vector<MeasuredContact> measured_contacts(const ContactProblem& problem);

/// Sets MeasuredContact::push from the impulses of all contacts.
void set_pushes(std::vector<MeasuredContact>& contacts, const Eigen::VectorXd& impulse);

/// Quantities of one contact in its laws, at given r and u.
struct NaturalTerms {
  Eigen::Vector3d velocity;  ///< u [m/s]
  Eigen::Vector3d nu;        ///< r + K (u + o) [N s]
  Eigen::Vector2d spring;    ///< kappa_t (u_t + o_t) [N s]
  Eigen::Vector2d radius;    ///< bound of friction of each tangent [N s]; law cone: twice the same
};

NaturalTerms natural_terms(const MeasuredContact& contact,
                           const Eigen::Vector3d& impulse,
                           const Eigen::Vector3d& velocity,
                           FrictionLaw law,
                           AdhesionRule rule);

/// rho_n, rho_t, rho_t of the natural map [kg]: rho_n = 1 / B_nn + kappa_n, rho_t = 1 / (largest
/// eigenvalue of the symmetric part of B_tt) + kappa_t; 1 for tangents that no impulse moves, which
/// check_problem() allows only where nothing resists sliding. Bilateral blocks: 1 / B_aa of each
/// row, rolling ones as contacts without springs; 1 for rows that no impulse moves.
Eigen::Vector3d natural_scale(const MeasuredContact& contact);

/// Energy [J] of the natural residual of one contact: 0 exactly where the laws hold.
///
/// With nu and R from natural_terms(), rho from natural_scale() and P the projection on the disc of
/// radius R (pyramid: on the rectangle):
///
///     e_n = min(nu_n, rho_n u_n),   e_t = nu_t - P(nu_t - rho_t u_t)
///     energy = e_n^2 / rho_n + |e_t|^2 / rho_t
///
/// Bilateral blocks: e = rho u. Rolling blocks: e = r - P(r - rho u), P the projections on the
/// interval of torsion and the disc of rolling.
double natural_energy(const MeasuredContact& contact,
                      const Eigen::Vector3d& impulse,
                      const Eigen::Vector3d& velocity,
                      FrictionLaw law,
                      AdhesionRule rule);

/// What r . B r adds to the scale of eta [J]: only as far as it stands above its own rounding, so
/// that huge impulses in the null space of B do not make a problem look solved.
/// @param work       r . B r
/// @param magnitude  |r| . |B| |r|
inline double resolved_energy(double work, double magnitude) {
  return std::max(work - 0x1p-49 * magnitude, 0.0);
}

/// error / scale; infinity unless both are finite.
inline double relative_error(double error, double scale) {
  const double ratio = error / std::max(scale, std::numeric_limits<double>::min());
  return std::isfinite(ratio) && std::isfinite(scale) ? ratio
                                                      : std::numeric_limits<double>::infinity();
}

/// Squared natural-map error of one contact as FCLIB defines it, without scaling by rho:
/// |nu - P(nu - u - mu |u_t| n)|^2, P the projection on Coulomb's cone. The pyramid and the
/// restrictive rule have no such cone; for them, and for blocks that are no contacts, it is |e|^2
/// of natural_energy() with rho = 1.
double fclib_square(const MeasuredContact& contact,
                    const Eigen::Vector3d& impulse,
                    const Eigen::Vector3d& velocity,
                    FrictionLaw law,
                    AdhesionRule rule);

}  // namespace tetwarp

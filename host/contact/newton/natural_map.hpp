/// @file natural_map.hpp
/// The contact laws as equations F(r, u) = 0 that are differentiable almost everywhere.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "host/contact/problem/measure.hpp"

namespace tetwarp {

/// Derivatives of the three equations of one contact.
struct MapDerivative {
  Eigen::Matrix3d by_impulse;
  Eigen::Matrix3d by_velocity;
};

/// With a steepness s > 0 and nu, rho and P as in natural_energy():
///
///     F_n = min(nu_n, s rho_n u_n) / sqrt(s rho_n)
///     F_t = (nu_t - P(nu_t - s rho_t u_t)) / sqrt(s rho_t)
///
/// The zeros do not depend on s. At s = 1, |F|^2 is the sum of natural_energy(). The larger s, the
/// larger the range of (r, u) in which a contact counts as closed and sticking.
///
/// Source: Alart, Curnier 1991; adhesion and the radius R as in contact.hpp.
class NaturalMap {
 public:
  /// @param contacts  with their diagonal blocks; bilateral blocks among them: F = s rho u /
  ///                  sqrt(s rho). No rolling blocks
  NaturalMap(std::vector<MeasuredContact> contacts, FrictionLaw law, AdhesionRule rule);

  /// F, [3 contacts].
  Eigen::VectorXd value(const Eigen::VectorXd& impulse,
                        const Eigen::VectorXd& velocity,
                        double steepness) const;

  /// F, and one element of its generalized Jacobian.
  /// @param derivatives  out, [contacts], scaled like F
  Eigen::VectorXd linearize(const Eigen::VectorXd& impulse,
                            const Eigen::VectorXd& velocity,
                            double steepness,
                            std::vector<MapDerivative>& derivatives) const;

  /// 1 / rho of every row, [3 contacts], 1/kg.
  const Eigen::VectorXd& compliance() const { return compliance_; }

 private:
  /// F of one contact before the division, and its derivatives by nu, and by u at constant nu.
  Eigen::Vector3d contact_value(std::size_t c,
                                const Eigen::Vector3d& impulse,
                                const Eigen::Vector3d& velocity,
                                double steepness,
                                MapDerivative& derivative) const;
  /// contact_value() of a bilateral block: rho u, or r of rows that no impulse moves.
  Eigen::Vector3d stop_rows(std::size_t c,
                            const Eigen::Vector3d& impulse,
                            const Eigen::Vector3d& velocity,
                            double steepness,
                            MapDerivative& derivative) const;
  /// Tangential rows of contact_value(), law cone: both together.
  void slide_on_disc(const MeasuredContact& contact,
                     const NaturalTerms& terms,
                     double rho,
                     Eigen::Vector3d& value,
                     MapDerivative& derivative) const;
  /// Law pyramid: tangent `axis`, 1 or 2.
  void slide_on_axis(const MeasuredContact& contact,
                     const NaturalTerms& terms,
                     double rho,
                     int axis,
                     Eigen::Vector3d& value,
                     MapDerivative& derivative) const;

  std::vector<MeasuredContact> contacts_;
  FrictionLaw law_;
  AdhesionRule rule_;
  double chi_;  ///< 1 with rule `restrictive`, else 0
  Eigen::VectorXd compliance_;
};

}  // namespace tetwarp

/// @file contact_bound.hpp
/// Bounds of eta where the blocks B of J A^-1 J^T are unknown but have lower bounds B'.
///
/// The weights of eta are rho(B) = 1 / B + kappa, so they lie between kappa and rho(B').
#pragma once
#include <cstdint>

#include "kernels/contact/contact_residual.hpp"

namespace tetwarp {

/// One index = one contact: a lower bound of its share in the eta of zero impulses, for every block
/// B that is at least B'.
///
/// Each term of the natural map rises with its weight, then falls, so its minimum is at an end of
/// the interval of weights. With tangential offsets this holds approximately: measured values of
/// the smallest sum over the ends are up to 2.2 % too high, so 20 % are subtracted. This margin is
/// not proven.
struct FreeResidualBoundOp {
  ContactResidualOp<double> natural;  ///< with blocks B', impulses zero, free velocities

  TETWARP_HD ContactSums operator()(std::int64_t i) const {
    constexpr double tiny = 1e-150, margin = 0.8;
    ContactSums sums = natural(i);
    const ContactConstants<double>& c = natural.constants[i];
    const double* r = natural.impulse.data + 3 * i;
    const double* u = natural.velocity.data + 3 * i;
    const double low_n = max_of(c.normal_spring, tiny), low_t = max_of(c.tangent_spring, tiny);
    const double high_n = normal_weight(c), high_t = tangent_weight(c);
    const auto energy = [&](double rho_n, double rho_t) {
      return natural_square(c, natural.switches, rho_n, rho_t, r, u);
    };
    if (!(sums.eta < INFINITY)) return sums;
    if (!is_contact(c.kind)) {
      // rho |u|^2 of bilateral rows falls with rho, which has no lower bound; rolling has no term.
      const double size = square_of(u[0]) + square_of(u[1]) + square_of(u[2]);
      sums.eta = sums.largest = c.kind == ContactKind::bilateral ? tiny * size : 0;
      return sums;
    }
    sums.eta = margin * min_of(min_of(energy(low_n, low_t), energy(low_n, high_t)),
                               min_of(energy(high_n, low_t), energy(high_n, high_t)));
    sums.largest = sums.eta;
    return sums;
  }
};

/// One index = one contact: an upper bound of its share in eta, for every block B that is at least
/// B'.
///
/// Let u' be velocities with which the impulses satisfy the law, and d = u - u'. The natural map is
/// zero at u'. Its slope in u_n is at most rho_n. In u_t it is at most rho_t, plus kappa_t where
/// the spring lowers the radius of friction, plus mu kappa_n from u_n through that radius:
///
///     e_n^2 / rho_n <= rho_n d_n^2,  |e_t| <= (rho_t + kappa_t) |d_t| + mu kappa_n |d_n|
///
/// If the law does not hold exactly at u' (bodies with several contacts, swept one after the
/// other), the residual there is added, in the weights rho(B'): then the result is an estimate.
struct ResidualBoundOp {
  ContactResidualOp<double> natural;       ///< with blocks B' and the velocities u
  View<const double> consistent_velocity;  ///< u'

  TETWARP_HD ContactSums operator()(std::int64_t i) const {
    ContactSums sums = natural(i);
    const ContactConstants<double>& c = natural.constants[i];
    const double* u = natural.velocity.data + 3 * i;
    const double* consistent = consistent_velocity.data + 3 * i;
    const double d_n = u[0] - consistent[0];
    const double d_t = sqrt(square_of(u[1] - consistent[1]) + square_of(u[2] - consistent[2]));
    // Bilateral rows: the natural map is rho u, and B' gives an upper bound of rho.
    if (c.kind == ContactKind::bilateral) return sums;
    if (c.kind == ContactKind::rolling) {
      const double moved = row_weight(c, 0) * d_n * d_n + rolling_weight(c) * d_t * d_t;
      const double rest = row_eta_square(c, natural.impulse.data + 3 * i, consistent);
      if (sums.eta < INFINITY) sums.eta = sums.largest = square_of(sqrt(rest) + sqrt(moved));
      return sums;
    }
    double square = normal_weight(c) * d_n * d_n;
    if (c.kind != ContactKind::frictionless) {
      const double rho_t = tangent_weight(c);
      const double slope = rho_t + (natural.switches.restrictive ? c.tangent_spring : 0.0);
      const double turn = c.friction * c.normal_spring * fabs(d_n);
      const double low = max_of(c.tangent_spring, 1e-300);
      square += square_of(slope / sqrt(rho_t) * d_t + (turn > 0 ? turn / sqrt(low) : 0.0));
    }
    const double left = eta_square(c, natural.switches, natural.impulse.data + 3 * i, consistent);
    const bool is_finite = sums.eta < INFINITY;
    sums.eta = sums.largest = is_finite ? square_of(sqrt(left) + sqrt(square)) : INFINITY;
    return sums;
  }
};

}  // namespace tetwarp

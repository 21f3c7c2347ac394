/// @file contact_tangent.hpp
/// The law of a contact without friction, linear about its impulse and velocity, for a step of
/// Newton's method.
#pragma once
#include "kernels/contact/contact_law.hpp"

namespace tetwarp {

/// The change of nu = r + K (u + o), the impulse without the springs, for a change du of the
/// velocity:
///
///     d nu = -offset - (slope du_n, 0, 0)
struct ContactTangent {
  double slope = 0;  ///< [kg]
  double offset[3] = {};
};

/// Linearizes nu_n = max(nu_n - rho u_n, 0), nu_t = 0. Contacts that push give way by `softness` /
/// rho, which keeps the equations regular where contacts are redundant (after Xiao, Li, Wen and
/// Zhang 2018).
struct ContactTangentOp {
  double softness;

  /// @param rho                as rho_n of natural_square()
  /// @param impulse, velocity  r and u, [3]
  TETWARP_HD ContactTangent operator()(const ContactConstants<double>& c,
                                       double rho,
                                       const double* impulse,
                                       const double* velocity) const {
    ContactTangent out;
    const double nu_n = impulse[0] + c.normal_spring * velocity[0];
    if (nu_n - rho * velocity[0] > 0) {
      out.slope = rho / softness;
      out.offset[0] = out.slope * velocity[0];
    } else {
      out.offset[0] = nu_n;
    }
    for (int a = 0; a < 2; ++a) {
      out.offset[1 + a] =
          impulse[1 + a] + c.tangent_spring * (velocity[1 + a] + c.tangent_offset[a]);
    }
    return out;
  }
};

}  // namespace tetwarp

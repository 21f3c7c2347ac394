/// @file contact_adhesion.hpp
/// Stage "adhesion" of the contact solver: one step of the adhesion intensity beta, after the solve
/// of the same step, which uses the old beta.
///
/// With p the contact pressure [Pa] and C g^2 twice the energy of the springs at beta = 1 [J/m^2],
///
///     beta' = r max(p - beta p0, 0) + min(W - C g^2 beta, 0) / eta
///
/// g consists of all three gaps in traction, of the tangential gaps in compression. Friction does
/// not change beta.
#pragma once
#include <cstdint>

#include "kernels/base/hd.hpp"
#include "kernels/base/view.hpp"

namespace tetwarp {

/// beta' = max(bonding - bonding_decay beta, 0) + min(cohesion - strain beta, 0), all [1/s], >= 0.
struct IntensityLaw {
  double bonding = 0;        ///< r p
  double bonding_decay = 0;  ///< r p0
  double cohesion = 0;       ///< W / eta
  double strain = 0;         ///< C g^2 / eta
};

TETWARP_HD double bonding_rate_of(const IntensityLaw& law, double beta) {
  return max_of(law.bonding - law.bonding_decay * beta, 0.0);
}

TETWARP_HD double debonding_rate_of(const IntensityLaw& law, double beta) {
  return min_of(law.cohesion - law.strain * beta, 0.0);
}

/// beta after `time` [s] of beta' = rate - decay (beta - start), from `start`.
TETWARP_HD double relaxed_intensity(double start, double rate, double decay, double time) {
  const double x = decay * time;
  return start + (x > 0 ? rate * (-expm1(-x) / decay) : rate * time);
}

/// Clamps to [0, 1], which rounding may exceed by one ulp.
TETWARP_HD double cut_intensity(double beta) {
  return min_of(max_of(beta, 0.0), 1.0);
}

/// Exact solution after `time` [s], clamped to [0, 1]. The rate is piecewise linear in beta and
/// does not grow with it: once at most, beta moves from an interval in which only bonding or only
/// debonding acts to the interval in which both act.
TETWARP_HD double exact_intensity(const IntensityLaw& law, double beta, double time) {
  const double bonding = bonding_rate_of(law, beta);
  const double debonding = debonding_rate_of(law, beta);
  const double rate = bonding + debonding;
  if (rate == 0) return beta;
  const double decay = (bonding > 0 ? law.bonding_decay : 0) + (debonding < 0 ? law.strain : 0);
  const double end = relaxed_intensity(beta, rate, decay, time);
  double corner;
  if (debonding == 0 && law.strain * end > law.cohesion) {
    corner = law.cohesion / law.strain;
  } else if (bonding == 0 && law.bonding_decay * end < law.bonding) {
    corner = law.bonding_decay > 0 ? law.bonding / law.bonding_decay : beta;
  } else {
    return cut_intensity(end);
  }
  const double share = (corner - beta) / rate;  // time to the corner at a constant rate
  const double passed = decay > 0 ? -log1p(-decay * share) / decay : share;
  const double both =
      (law.bonding - law.bonding_decay * corner) + (law.cohesion - law.strain * corner);
  const double left = time - passed > 0 ? time - passed : 0;  // 0 also if `passed` is NaN
  return cut_intensity(relaxed_intensity(corner, both, law.bonding_decay + law.strain, left));
}

/// One explicit Euler step, clamped to [0, 1]; for comparison. It overshoots the equilibrium where
/// a decay rate times `time` exceeds 1.
TETWARP_HD double euler_intensity(const IntensityLaw& law, double beta, double time) {
  const double rate = bonding_rate_of(law, beta) + debonding_rate_of(law, beta);
  return cut_intensity(beta + time * rate);
}

/// values[i], or `otherwise` if the vector is empty.
TETWARP_HD double value_or(View<const double> values, std::int64_t i, double otherwise) {
  return values.size > 0 ? values[i] : otherwise;
}

/// Input of the stage, as in AdhesionState; an empty view is a vector that was not given.
struct AdhesionViews {
  double time_step;  ///< [s], > 0
  View<const double> area;
  View<const double> stiffness;
  View<const double> tangential_stiffness;
  View<const double> intensity;
  View<const double> gap;
  View<const double> energy;
  View<const double> viscosity;
  View<const double> bonding_rate;
  View<const double> saturation_pressure;
  View<const double> impulse;               ///< r of the solve, shape [3 contacts], N s
  View<const double> velocity;              ///< u of the solve, shape [3 contacts], m/s
  View<const double> pressing = {};         ///< normal impulse on each area, shape [contacts], N s;
                                            ///< empty: that of `impulse`
  View<const double> velocity_offset = {};  ///< w, shape [3 contacts], m/s; empty: gap_n is dt w_n
};

/// One index = one contact; any order. Outputs may be the arrays of the inputs.
struct ContactAdhesionOp {
  AdhesionViews in;
  bool euler;
  double debond_gap_factor;
  double debond_intensity;
  View<double> next_intensity;
  View<double> next_gap;
  View<std::uint8_t> debonded;

  TETWARP_HD void operator()(std::int64_t c) const {
    const double dt = in.time_step;
    const double area = value_or(in.area, c, 0);
    const double stiffness = value_or(in.stiffness, c, 0);
    const double beta = in.intensity[c];
    double normal_gap = dt * in.velocity[3 * c];
    if (in.velocity_offset.size > 0 && in.gap.size > 0) {
      normal_gap += in.gap[3 * c] - dt * in.velocity_offset[3 * c];
    }
    const double gap_1 = value_or(in.gap, 3 * c + 1, 0) + dt * in.velocity[3 * c + 1];
    const double gap_2 = value_or(in.gap, 3 * c + 2, 0) + dt * in.velocity[3 * c + 2];
    const double push = in.impulse[3 * c];
    const double press = in.pressing.size > 0 ? in.pressing[c] : push;

    // Twice the energy per area at beta = 1; debonding starts when it reaches W.
    double strain =
        value_or(in.tangential_stiffness, c, stiffness) * (gap_1 * gap_1 + gap_2 * gap_2);
    if (!(push > 0)) strain += stiffness * normal_gap * normal_gap;
    const double energy = value_or(in.energy, c, 0);
    const double viscosity = in.energy.size > 0 ? value_or(in.viscosity, c, 0) : 0;
    IntensityLaw law;
    if (press > 0 && area > 0) {
      law.bonding = value_or(in.bonding_rate, c, 0) * (press / (dt * area));
      law.bonding_decay = value_or(in.bonding_rate, c, 0) * value_or(in.saturation_pressure, c, 0);
    }
    if (viscosity > 0) {
      law.cohesion = energy / viscosity;
      law.strain = strain / viscosity;
    }

    double next = euler ? euler_intensity(law, beta, dt) : exact_intensity(law, beta, dt);
    const bool torn = strain > debond_gap_factor * debond_gap_factor * energy;
    const bool debonds = beta > 0 && viscosity > 0 &&
                         (torn || (!(push > 0 || press > 0) && next < debond_intensity));
    if (debonds) next = 0;
    // New bonds form without tension: the gap is reduced so that the force beta^2 C g does not
    // jump; the stored energy decreases by the same factor.
    double keep = next > 0 ? 1 : 0;
    if (next > beta) keep = (beta / next) * (beta / next);
    next_intensity[c] = next;
    next_gap[3 * c] = normal_gap;
    next_gap[3 * c + 1] = keep * gap_1;
    next_gap[3 * c + 2] = keep * gap_2;
    if (debonded.size > 0) debonded[c] = debonds;
  }
};

/// Advances the intensity of every contact by one time step and moves its tangential anchors.
///
/// A contact debonds, beta = 0, if debonding is on (energy and viscosity > 0) and C g^2 exceeds
/// `debond_gap_factor`^2 W, or if its intensity falls below `debond_intensity` while nothing
/// presses on it. The law
/// alone would converge to W / (C g^2) > 0.
/// @param exec  where to run
/// @param body  inputs and outputs, shapes as in AdhesionState and AdhesionStep
///
/// Determinism: same bits for any number of threads; back ends differ by the rounding of expm1 and
/// log1p. Cost: one or two exponentials per contact.
/// Source: Gascon 2010, section 4.3.3, with the gap in place of the traction, and with bonding in
/// compression; the closed form and the moved anchors are ours.
template <class Exec>
void contact_adhesion(Exec& exec, const ContactAdhesionOp& body) {
  exec.for_each("contact/adhesion", body.next_intensity.size, body);
}

}  // namespace tetwarp

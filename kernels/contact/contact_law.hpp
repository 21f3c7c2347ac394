/// @file contact_law.hpp
/// The law of one contact: the impulse it answers with while all other impulses stand still.
///
/// Letters: r impulse, u velocity, B the contact's own 3x3 block of the Delassus matrix,
/// K = diag(kappa_n, kappa_t, kappa_t) the adhesive springs over one step, o_t the stored
/// tangential gap over dt, nu = r + K (u + o) what contact and friction alone carry, R the radius
/// of friction.
#pragma once
#include <cstdint>

#include "kernels/base/hd.hpp"

namespace tetwarp {

/// Which law and which rule; see host/tetwarp/contact.hpp.
struct ContactSwitches {
  bool pyramid = false;
  bool restrictive = false;
};

/// How much of the law a contact needs.
enum class ContactKind : std::uint8_t {
  frictionless,  ///< no friction, no springs: the normal row is all there is
  coulomb,       ///< friction, no springs
  adhesive       ///< springs, with or without friction
};

/// What does not change during a solve, per contact.
template <class T>
struct ContactConstants {
  T block[9];           ///< B, row by row
  T tangent_metric;     ///< largest eigenvalue of the symmetric tangential 2x2 block of B
  T friction;           ///< mu
  T normal_spring;      ///< kappa_n
  T tangent_spring;     ///< kappa_t
  T tangent_offset[2];  ///< o_t
  ContactKind kind;
};

/// Largest eigenvalue of [a b; b c].
template <class T>
TETWARP_HD T larger_eigenvalue(T a, T b, T c) {
  return (a + c) / 2 + sqrt(square_of((a - c) / 2) + square_of(b));
}

/// Normal impulse that answers the velocity `free` left by all others: compression stops it,
/// traction stretches the spring (the proximal map of the spring's energy).
template <class T>
TETWARP_HD T normal_impulse(T free, T metric, T spring) {
  return free <= 0 ? -free / metric : -spring * free / (1 + spring * metric);
}

/// Slip speed s in [0, free] of  s + m max(limit - kappa |s d + o|, 0) = free,  with m kappa =
/// `coupling` < 1, `along` = d . o, `across` = |o|^2 - along^2: rule `restrictive` while sliding.
/// The left side grows with s, so the root is unique; `rest` = 1 - coupling, exact for stiff
/// springs.
template <class T>
TETWARP_HD T restrictive_slip(T free, T limit, T m, T coupling, T rest, T along, T across) {
  const T kappa = coupling / m;
  if (square_of(limit) <= square_of(kappa) * (square_of(free + along) + across)) return free;
  // (s - a)^2 = coupling^2 |s d + o|^2 on the branch s >= a, a = free - m limit.
  const T a = free - m * limit;
  const T scale = rest * (1 + coupling);  // 1 - coupling^2
  const T middle = a + square_of(coupling) * along;
  const T spread = coupling * sqrt(square_of(a + along) + scale * across);
  // Of two equal forms the one without cancellation.
  const T product = square_of(a) - square_of(coupling) * (square_of(along) + across);
  const T slip = middle >= 0 ? (middle + spread) / scale : product / (middle - spread);
  return min_of(max_of(slip, T(0)), free);
}

/// Friction (without the springs) against the velocity `free` in metric m = p / (1 + kappa p):
/// its size along -free, for |free| = `speed`.
template <class T>
TETWARP_HD T
friction_size(T speed, T limit, T spring, T metric, T along, T across, bool restrictive) {
  const T rest = 1 / (1 + spring * metric);
  const T m = metric * rest;
  const bool springs_count = restrictive && spring > 0;
  const T stick_limit =
      springs_count ? max_of(limit - spring * T(sqrt(square_of(along) + across)), T(0)) : limit;
  if (speed <= m * stick_limit) return speed / m;
  if (!springs_count) return limit;
  const T slip = restrictive_slip(speed, limit, m, spring * m, rest, along, across);
  return max_of(limit - spring * T(sqrt(square_of(slip + along) + across)), T(0));
}

/// Both tangential impulses at once, in the scalar metric of the constants (cone).
template <class T>
TETWARP_HD void cone_impulses(
    const ContactConstants<T>& c, bool restrictive, T limit, const T* free, T* impulse) {
  const T metric = c.tangent_metric;
  if (c.kind == ContactKind::coulomb) {
    const T speed = sqrt(square_of(free[0]) + square_of(free[1]));
    const T size =
        speed > 0 ? friction_size(speed, limit, T(0), metric, T(0), T(0), false) / speed : T(0);
    impulse[0] = -size * free[0];
    impulse[1] = -size * free[1];
    return;
  }
  const T spring = c.tangent_spring;
  const T rest = 1 / (1 + spring * metric);
  const T m = metric * rest;
  // Velocity with the springs but without friction.
  const T x = (free[0] - metric * spring * c.tangent_offset[0]) * rest;
  const T y = (free[1] - metric * spring * c.tangent_offset[1]) * rest;
  const T speed = sqrt(square_of(x) + square_of(y));
  T size = 0;  // friction over speed
  if (speed > 0) {
    const T along = (x * c.tangent_offset[0] + y * c.tangent_offset[1]) / speed;
    const T across = square_of((x * c.tangent_offset[1] - y * c.tangent_offset[0]) / speed);
    size = friction_size(speed, limit, spring, metric, along, across, restrictive) / speed;
  }
  // r = nu - kappa (u + o) with u = (1 - m size) x.
  const T slip = 1 - m * size;
  impulse[0] = -size * x - spring * (slip * x + c.tangent_offset[0]);
  impulse[1] = -size * y - spring * (slip * y + c.tangent_offset[1]);
}

/// One tangential impulse (pyramid: each axis for itself).
template <class T>
TETWARP_HD T
axis_impulse(const ContactConstants<T>& c, bool restrictive, T limit, T free, T metric, T offset) {
  const T spring = c.tangent_spring;
  const T rest = 1 / (1 + spring * metric);
  const T x = (free - metric * spring * offset) * rest;
  const T sign = x < 0 ? T(-1) : T(1);
  const T size =
      sign * friction_size(sign * x, limit, spring, metric, sign * offset, T(0), restrictive);
  return -size - spring * (x - metric * rest * size + offset);
}

/// Whether its normal row is all there is to solve.
template <class T>
TETWARP_HD bool has_one_row(const ContactConstants<T>& c, const T* impulse) {
  return c.kind == ContactKind::frictionless && impulse[1] == 0 && impulse[2] == 0;
}

/// Replaces the normal impulse by the answer to the normal velocity; returns its change.
template <class T>
TETWARP_HD T solve_normal(const ContactConstants<T>& c, T velocity, T* impulse) {
  const T before = impulse[0];
  impulse[0] = normal_impulse(velocity - c.block[0] * before, c.block[0], c.normal_spring);
  return impulse[0] - before;
}

/// Replaces `impulse` by the answer to `velocity` (u = B impulse + what all others do; changed on
/// the way): normal first, then the tangents under the friction that the new normal allows. Its
/// fixed point over all contacts is the exact law.
template <class T>
TETWARP_HD void solve_contact(const ContactConstants<T>& c,
                              ContactSwitches switches,
                              T* velocity,
                              T* impulse) {
  const T* b = c.block;
  const T change = solve_normal(c, velocity[0], impulse);
  if (c.kind == ContactKind::frictionless) {
    impulse[1] = impulse[2] = 0;
    return;
  }
  velocity[1] += b[3] * change;
  velocity[2] += b[6] * change;
  const T limit = c.friction * max_of(impulse[0], T(0));
  if (!switches.pyramid) {
    const T free[2] = {velocity[1] - c.tangent_metric * impulse[1],
                       velocity[2] - c.tangent_metric * impulse[2]};
    cone_impulses(c, switches.restrictive, limit, free, impulse + 1);
    return;
  }
  const T first = axis_impulse(c, switches.restrictive, limit, velocity[1] - b[4] * impulse[1],
                               b[4], c.tangent_offset[0]);
  velocity[2] += b[7] * (first - impulse[1]);
  impulse[1] = first;
  impulse[2] = axis_impulse(c, switches.restrictive, limit, velocity[2] - b[8] * impulse[2], b[8],
                            c.tangent_offset[1]);
}

}  // namespace tetwarp

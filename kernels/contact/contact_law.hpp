/// @file contact_law.hpp
/// The law of one contact: its impulse for given velocities while all other impulses are constant.
///
/// Letters: r impulse, u velocity, B the contact's own 3x3 block of the Delassus matrix,
/// K = diag(kappa_n, kappa_t, kappa_t) the adhesive springs over one step, o_t the stored
/// tangential gap over dt, nu = r + K (u + o) the impulse of contact and friction without the
/// springs, R the radius of friction.
#pragma once
#include <cstdint>

#include "kernels/base/hd.hpp"

namespace tetwarp {

/// The friction law and the adhesion rule; see host/tetwarp/contact.hpp.
struct ContactSwitches {
  bool pyramid = false;      ///< FrictionLaw::pyramid, else cone
  bool restrictive = false;  ///< AdhesionRule::restrictive, else parallel
  bool operator==(const ContactSwitches&) const = default;
};

/// The parts of the law that a contact needs.
enum class ContactKind : std::uint8_t {
  frictionless,  ///< neither friction nor tangential spring: normal row only
  coulomb,       ///< friction, no springs
  adhesive,      ///< springs, with or without friction
  bilateral,     ///< not a contact: rows whose velocity is zero; see row_law.hpp
  rolling        ///< not a contact: torsional and rolling friction of one; see row_law.hpp
};

/// Whether a block of three rows is a contact.
TETWARP_HD bool is_contact(ContactKind kind) {
  return kind < ContactKind::bilateral;
}

/// The constants of one contact, or of another block of three rows, during a solve. The members of
/// a `rolling` block have other meanings, see row_law.hpp; those of a `bilateral` block are 0
/// except `block`.
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

/// Normal impulse for the normal velocity `free` without it. In compression it stops the approach;
/// in traction it is the force of the stretched spring (the proximal map of the spring's energy).
/// @param metric  normal entry of B, 1/kg
/// @param spring  kappa_n
template <class T>
TETWARP_HD T normal_impulse(T free, T metric, T spring) {
  return free <= 0 ? -free / metric : -spring * free / (1 + spring * metric);
}

/// Slip speed under the rule `restrictive`: the s in [0, free] with
///
///     s + m max(limit - kappa |s d + o|, 0) = free
///
/// where m kappa = `coupling` < 1, `along` = d . o, `across` = |o|^2 - along^2 for the direction d
/// of sliding. The left side grows with s, so the root is unique.
/// @param complement  1 - coupling, given by the caller without cancellation for stiff springs
template <class T>
TETWARP_HD T restrictive_slip(T free, T limit, T m, T coupling, T complement, T along, T across) {
  const T kappa = coupling / m;
  if (square_of(limit) <= square_of(kappa) * (square_of(free + along) + across)) return free;
  // (s - a)^2 = coupling^2 |s d + o|^2 on the branch s >= a, a = free - m limit.
  const T a = free - m * limit;
  const T scale = complement * (1 + coupling);  // 1 - coupling^2
  const T middle = a + square_of(coupling) * along;
  const T spread = coupling * sqrt(square_of(a + along) + scale * across);
  // The form of two that has no cancellation.
  const T product = square_of(a) - square_of(coupling) * (square_of(along) + across);
  const T slip = middle >= 0 ? (middle + spread) / scale : product / (middle - spread);
  return min_of(max_of(slip, T(0)), free);
}

/// Magnitude of the friction impulse (without the springs) at a free tangential velocity of
/// magnitude `speed`; it is directed against that velocity.
/// @param limit   radius of friction, mu times the normal impulse
/// @param metric  p; with the spring the effective metric is m = p / (1 + kappa p)
/// @param along, across  stored gap along the velocity; square of the part across it
template <class T>
TETWARP_HD T
friction_size(T speed, T limit, T spring, T metric, T along, T across, bool restrictive) {
  const T complement = 1 / (1 + spring * metric);  // 1 - m kappa
  const T m = metric * complement;
  const bool springs_count = restrictive && spring > 0;
  const T stick_limit =
      springs_count ? max_of(limit - spring * T(sqrt(square_of(along) + across)), T(0)) : limit;
  if (speed <= m * stick_limit) return speed / m;
  if (!springs_count) return limit;
  const T slip = restrictive_slip(speed, limit, m, spring * m, complement, along, across);
  return max_of(limit - spring * T(sqrt(square_of(slip + along) + across)), T(0));
}

/// Both tangential impulses under the friction cone, in the scalar metric of the constants.
/// @param free     tangential velocity without the tangential impulse, [2]
/// @param impulse  out: tangential impulses, [2]
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
  const T complement = 1 / (1 + spring * metric);
  const T m = metric * complement;
  // Velocity with the springs but without friction.
  const T x = (free[0] - metric * spring * c.tangent_offset[0]) * complement;
  const T y = (free[1] - metric * spring * c.tangent_offset[1]) * complement;
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

/// One tangential impulse under the friction pyramid, whose axes are independent.
/// @param free  velocity along the axis without this impulse
template <class T>
TETWARP_HD T
axis_impulse(const ContactConstants<T>& c, bool restrictive, T limit, T free, T metric, T offset) {
  const T spring = c.tangent_spring;
  const T complement = 1 / (1 + spring * metric);
  const T x = (free - metric * spring * offset) * complement;
  const T sign = x < 0 ? T(-1) : T(1);
  const T size =
      sign * friction_size(sign * x, limit, spring, metric, sign * offset, T(0), restrictive);
  return -size - spring * (x - metric * complement * size + offset);
}

/// Whether only the normal row of a contact is solved.
template <class T>
TETWARP_HD bool has_one_row(const ContactConstants<T>& c, const T* impulse) {
  return c.kind == ContactKind::frictionless && impulse[1] == 0 && impulse[2] == 0;
}

/// Replaces the normal impulse by the solution for the normal velocity u_n; returns its change.
template <class T>
TETWARP_HD T solve_normal(const ContactConstants<T>& c, T velocity, T* impulse) {
  const T before = impulse[0];
  impulse[0] = normal_impulse(velocity - c.block[0] * before, c.block[0], c.normal_spring);
  return impulse[0] - before;
}

/// Replaces the impulse of a contact by the solution of its law while the other impulses are
/// constant: first the normal part, then the tangents under the friction limit of the new normal
/// impulse. Impulses that no such update changes satisfy the law exactly.
/// @param velocity  in: u with the old impulse; overwritten, [3]
/// @param impulse   in and out: r, [3]
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

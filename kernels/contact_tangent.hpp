/// @file contact_tangent.hpp
/// Stage "tangent" of the contact solver: a contact law as an affine spring around the state at
/// hand, for Newton steps on bodies that A couples.
#pragma once
#include <cstdint>

#include "kernels/contact_law.hpp"
#include "kernels/view.hpp"

namespace tetwarp {

/// r(u + du) = anchor - S du, S symmetric: the normal alone, the tangents together.
template <class T>
struct ContactTangent {
  T anchor[3];
  T normal;
  T tangent[3];  ///< [t1 t1, t1 t2, t2 t2]

  /// S du.
  TETWARP_HD void apply(const T* du, T* force) const {
    force[0] = normal * du[0];
    force[1] = tangent[0] * du[1] + tangent[1] * du[2];
    force[2] = tangent[1] * du[1] + tangent[2] * du[2];
  }
};

/// In which metrics a law is taken apart. The state of a contact (closed or open, stick or slip)
/// is read with its own metric p, which is robust; then rows that must stand still get the
/// stiffness `hard` / p (with the old impulse as multiplier), and the others are linearized with p
/// / `soft`, close to the law itself.
struct TangentMetrics {
  static constexpr double hard = 3;
  static constexpr double soft = 10;
};

/// Tangential part of one axis (pyramid).
template <class T>
TETWARP_HD void axis_tangent(
    bool restrictive, T limit, T spring, T metric, T offset, T u, T r, T* anchor, T* stiffness) {
  const auto split = [&](T p, T* x, T* size) {
    const T free = (u - p * r - p * spring * offset) / (1 + spring * p);
    const T sign = free < 0 ? T(-1) : T(1);
    *x = free;
    *size = sign * friction_size(sign * free, limit, spring, p, sign * offset, T(0), restrictive);
  };
  T x, size;
  split(metric, &x, &size);
  if (fabs(x) <= metric / (1 + spring * metric) * fabs(size)) {
    *stiffness = T(TangentMetrics::hard) / metric;
    *anchor = r - *stiffness * u;
    return;
  }
  const T p = metric / T(TangentMetrics::soft);
  split(p, &x, &size);
  *stiffness = spring / (1 + spring * p);
  *anchor = -size - spring * (x - p / (1 + spring * p) * size + offset);
}

/// Tangential part of both axes together (cone).
template <class T>
TETWARP_HD void cone_tangent(const ContactConstants<T>& c,
                             bool restrictive,
                             T limit,
                             T metric,
                             const T* u,
                             const T* r,
                             ContactTangent<T>& out) {
  const T spring = c.tangent_spring;
  const T* o = c.tangent_offset;
  T x[2], speed, size;
  const auto split = [&](T p) {
    for (int a = 0; a < 2; ++a) x[a] = (u[a] - p * r[a] - p * spring * o[a]) / (1 + spring * p);
    speed = sqrt(square_of(x[0]) + square_of(x[1]));
    const T along = speed > 0 ? (x[0] * o[0] + x[1] * o[1]) / speed : T(0);
    const T across = speed > 0 ? square_of((x[0] * o[1] - x[1] * o[0]) / speed) : T(0);
    size = friction_size(speed, limit, spring, p, along, across, restrictive);
  };
  split(metric);
  if (speed <= metric / (1 + spring * metric) * size) {
    const T stiffness = T(TangentMetrics::hard) / metric;
    out.tangent[0] = out.tangent[2] = stiffness;
    out.tangent[1] = 0;
    for (int a = 0; a < 2; ++a) out.anchor[1 + a] = r[a] - stiffness * u[a];
    return;
  }
  const T p = metric / T(TangentMetrics::soft);
  split(p);
  // f = -size d with d = x / |x|: only the part across d changes with x.
  const T rest = 1 / (1 + spring * p);
  const T ratio = speed > 0 ? size / speed : T(0);
  const T slip = 1 - p * rest * ratio;
  const T turn = rest * (ratio - spring * p * rest * ratio);
  const T d[2] = {speed > 0 ? x[0] / speed : T(1), speed > 0 ? x[1] / speed : T(0)};
  out.tangent[0] = rest * spring + turn * d[1] * d[1];
  out.tangent[1] = -turn * d[0] * d[1];
  out.tangent[2] = rest * spring + turn * d[0] * d[0];
  for (int a = 0; a < 2; ++a) out.anchor[1 + a] = -ratio * x[a] - spring * (slip * x[a] + o[a]);
}

/// The law around velocity u and impulse r. Couplings of the friction radius to the normal are left
/// out of S: they would make it asymmetric.
template <class T>
TETWARP_HD ContactTangent<T> tangent_of(const ContactConstants<T>& c,
                                        ContactSwitches switches,
                                        const T* u,
                                        const T* r) {
  ContactTangent<T> out = {};
  const T metric = c.block[0];
  const T spring = c.normal_spring;
  const T free = u[0] - metric * r[0];
  if (free <= 0) {
    out.normal = T(TangentMetrics::hard) / metric;
    out.anchor[0] = r[0] - out.normal * u[0];
  } else {
    const T p = metric / T(TangentMetrics::soft);
    out.normal = spring / (1 + spring * p);
    out.anchor[0] = -out.normal * (u[0] - p * r[0]);
  }
  if (c.kind == ContactKind::frictionless) return out;
  const T limit = c.friction * max_of(normal_impulse(free, metric, spring), T(0));
  if (!switches.pyramid) {
    cone_tangent(c, switches.restrictive, limit, c.tangent_metric, u + 1, r + 1, out);
    return out;
  }
  for (int a = 0; a < 2; ++a) {
    axis_tangent(switches.restrictive, limit, c.tangent_spring, c.tangent_metric,
                 c.tangent_offset[a], u[1 + a], r[1 + a], &out.anchor[1 + a], &out.tangent[2 * a]);
  }
  return out;
}

/// One index = one contact: its tangent; constants hold plain metrics on the diagonal of `block`.
template <class T>
struct ContactTangentBody {
  View<const ContactConstants<T>> constants;
  ContactSwitches switches;
  View<const T> velocity;
  View<const T> impulse;
  View<ContactTangent<T>> tangents;

  TETWARP_HD void operator()(std::int64_t c) const {
    tangents[c] = tangent_of(constants[c], switches, velocity.data + 3 * c, impulse.data + 3 * c);
  }
};

}  // namespace tetwarp

/// @file contact_residual.hpp
/// Stage "residual" of the contact solver: the distance of impulses and velocities from the law.
#pragma once
#include <cstdint>

#include "kernels/base/plain_sums.hpp"
#include "kernels/base/view.hpp"
#include "kernels/contact/body_relax.hpp"
#include "kernels/contact/contact_law.hpp"
#include "kernels/contact/contact_sweep.hpp"
#include "kernels/contact/row_law.hpp"

namespace tetwarp {

/// Sums over contacts, in float64 for solves of either precision.
struct ContactSums {
  double eta = 0;    ///< e_n^2 / rho_n + |e_t|^2 / rho_t: an energy [J]
  double fclib = 0;  ///< |r - P(r - u~)|^2, P: projection on the friction cone, u~ = u + mu |u_t| n
  double work = 0;   ///< r . (u - q) = r . B r
  double row_work = 0;   ///< sum of r_i^2 B_ii: |r| . |B| |r| is at most this by the number of rows
  double magnitude = 0;  ///< |r| . |B| |r|, what cancels in `work`; see ContactPipeline::measure()
  double largest = 0;    ///< largest term of `eta`
  double deepest = 0;    ///< largest -u_n [m/s]
  std::int64_t largest_contact = -1;

  TETWARP_HD ContactSums& operator+=(const ContactSums& other) {
    eta += other.eta;
    fclib += other.fclib;
    work += other.work;
    row_work += other.row_work;
    magnitude += other.magnitude;
    deepest = max_of(deepest, other.deepest);
    if (other.largest > largest) {
      largest = other.largest;
      largest_contact = other.largest_contact;
    }
    return *this;
  }
};

/// The part of `work` that exceeds its own rounding errors. Without this limit, huge impulses that
/// cause no velocity (in the null space of B) would enlarge the scale of eta by rounding errors,
/// and a problem without a solution would seem solved.
TETWARP_HD double resolved_work(const ContactSums& sums) {
  constexpr double rounding = 0x1p-49;
  return max_of(sums.work - rounding * sums.magnitude, 0.0);
}

/// Energy [J] of the rounding errors of the velocities from which the residual is computed: a
/// residual below it is not resolved.
TETWARP_HD double unresolved_energy(const ContactSums& sums) {
  constexpr double rounding = 0x1p-53;
  return square_of(rounding) * sums.magnitude;
}

/// |e_n|^2 / rho_n + |e_t|^2 / rho_t with e the natural map of the law; zero exactly if the law
/// holds.
template <class T>
TETWARP_HD double natural_square(const ContactConstants<T>& c,
                                 ContactSwitches switches,
                                 double rho_n,
                                 double rho_t,
                                 const T* impulse,
                                 const T* velocity) {
  const double kappa_t = c.tangent_spring;
  const double nu_n = impulse[0] + double{c.normal_spring} * velocity[0];
  // e (e / rho) instead of e^2 / rho: the squares of very small impulses would be 0.
  const double e_n = min_of(nu_n, rho_n * velocity[0]);
  const double sum = e_n * (e_n / rho_n);
  if (c.kind == ContactKind::frictionless) return sum;
  const double limit = c.friction * max_of(nu_n, 0.0);
  double spring[2], nu[2], aim[2];
  for (int a = 0; a < 2; ++a) {
    spring[a] = kappa_t * (velocity[1 + a] + double{c.tangent_offset[a]});
    nu[a] = impulse[1 + a] + spring[a];
    aim[a] = nu[a] - rho_t * velocity[1 + a];
  }
  if (switches.pyramid) {
    for (int a = 0; a < 2; ++a) {
      const double radius = max_of(limit - (switches.restrictive ? fabs(spring[a]) : 0.0), 0.0);
      aim[a] = min_of(max_of(aim[a], -radius), radius);
    }
  } else {
    const double pull = sqrt(square_of(spring[0]) + square_of(spring[1]));
    const double radius = max_of(limit - (switches.restrictive ? pull : 0.0), 0.0);
    const double length = sqrt(square_of(aim[0]) + square_of(aim[1]));
    const double scale = length > radius ? radius / length : 1;
    aim[0] *= scale;
    aim[1] *= scale;
  }
  const double e_t[2] = {nu[0] - aim[0], nu[1] - aim[1]};
  const double weight = 1 / rho_t;
  return sum + e_t[0] * (e_t[0] * weight) + e_t[1] * (e_t[1] * weight);
}

/// Weights of eta: rho_n = 1 / B_nn + kappa_n, rho_t = 1 / lambda_max(B_tt) + kappa_t.
template <class T>
TETWARP_HD double normal_weight(const ContactConstants<T>& c) {
  return 1 / double{c.block[0]} + double{c.normal_spring};
}
template <class T>
TETWARP_HD double tangent_weight(const ContactConstants<T>& c) {
  return c.tangent_metric > 0 ? 1 / double{c.tangent_metric} + double{c.tangent_spring} : 1;
}

/// The term of one contact in ContactSums::eta.
template <class T>
TETWARP_HD double eta_square(const ContactConstants<T>& c,
                             ContactSwitches switches,
                             const T* impulse,
                             const T* velocity) {
  if (!is_contact(c.kind)) return row_eta_square(c, impulse, velocity);
  return natural_square(c, switches, normal_weight(c), tangent_weight(c), impulse, velocity);
}

/// The term of one contact in ContactSums::fclib: |nu - P(nu - u~)|^2 with u~ = u + mu |u_t| n and
/// P the projection on the friction cone. For laws without a cone: the natural map with weights 1.
template <class T>
TETWARP_HD double fclib_square(const ContactConstants<T>& c,
                               ContactSwitches switches,
                               const T* impulse,
                               const T* velocity) {
  if (!is_contact(c.kind)) return row_plain_square(c, impulse, velocity);
  if (switches.pyramid || (switches.restrictive && c.tangent_spring > 0)) {
    return natural_square(c, switches, 1, 1, impulse, velocity);
  }
  const double friction = c.friction;
  const double u[3] = {double{velocity[0]}, double{velocity[1]}, double{velocity[2]}};
  double nu[3] = {impulse[0] + double{c.normal_spring} * u[0], 0, 0};
  for (int a = 0; a < 2; ++a) {
    nu[1 + a] =
        impulse[1 + a] + double{c.tangent_spring} * (u[1 + a] + double{c.tangent_offset[a]});
  }
  const double slip = sqrt(u[1] * u[1] + u[2] * u[2]);
  double aim[3] = {nu[0] - u[0] - friction * slip, nu[1] - u[1], nu[2] - u[2]};
  const double tangent = sqrt(aim[1] * aim[1] + aim[2] * aim[2]);
  if (aim[0] <= -friction * tangent) {
    aim[0] = aim[1] = aim[2] = 0;
  } else if (tangent > friction * aim[0]) {
    aim[0] = (friction * tangent + aim[0]) / (1 + friction * friction);
    aim[1] *= friction * aim[0] / tangent;
    aim[2] *= friction * aim[0] / tangent;
  }
  double sum = 0;
  for (int a = 0; a < 3; ++a) sum += square_of(nu[a] - aim[a]);
  return sum;
}

/// One index = one contact: its terms, from its impulse and velocity.
template <class T>
struct ContactResidualOp {
  View<const ContactConstants<T>> constants;
  ContactSwitches switches;
  View<const T> impulse;
  View<const T> velocity;
  View<const T> free_velocity;

  TETWARP_HD ContactSums operator()(std::int64_t c) const {
    const T* r = impulse.data + 3 * c;
    const T* u = velocity.data + 3 * c;
    ContactSums sums;
    sums.eta = eta_square(constants[c], switches, r, u);
    sums.largest_contact = c;
    sums.fclib = fclib_square(constants[c], switches, r, u);
    sums.deepest = is_contact(constants[c].kind) ? max_of(-double{u[0]}, 0.0) : 0.0;
    double parts = 0;
    for (int a = 0; a < 3; ++a) {
      sums.work += r[a] * (double{u[a]} - free_velocity[3 * c + a]);
      sums.row_work += double{r[a]} * r[a] * fabs(double{constants[c].block[4 * a]});
      parts += fabs(double{r[a]}) + fabs(double{u[a]});
    }
    // A comparison with NaN is false and could hide it from the sums.
    if (!(parts < INFINITY)) sums.eta = sums.fclib = sums.deepest = INFINITY;
    sums.largest = sums.eta;
    return sums;
  }
};

/// One index = one contact of a Delassus matrix: its term in ContactSums::magnitude.
template <class T>
struct DelassusMagnitudeOp {
  DelassusView<T> delassus;
  View<const T> impulse;

  TETWARP_HD PlainSums<1> operator()(std::int64_t c) const {
    double change[3] = {0, 0, 0};
    for (std::int64_t k = delassus.row_start[c]; k < delassus.row_start[c + 1]; ++k) {
      const T* w = delassus.blocks.data + 9 * k;
      const T* r = impulse.data + 3 * std::int64_t{delassus.column[k]};
      for (int e = 0; e < 9; ++e) change[e / 3] += fabs(double{w[e]} * r[e % 3]);
    }
    double sum = 0;
    for (int a = 0; a < 3; ++a) sum += fabs(double{impulse[3 * c + a]}) * change[a];
    return {{sum}};
  }
};

/// One index = one body: its term in ContactSums::magnitude, (|J|^T |r|) . (|A^-1 J^T| |r|). The
/// sum over bodies is at least |r| . |B| |r|, since velocities are computed body by body.
template <class T>
struct BodyMagnitudeOp {
  BlockContacts contacts;
  View<const std::int64_t> dof_start;
  View<const T> jacobian, response, impulse;

  TETWARP_HD PlainSums<1> operator()(std::int64_t b) const {
    const std::int64_t size = dof_start[b + 1] - dof_start[b];
    double sum = 0;
    for (std::int64_t k = 0; k < size; ++k) {
      double push = 0, change = 0;
      for (std::int64_t p = contacts.start[b]; p < contacts.start[b + 1]; ++p) {
        const T* r = impulse.data + 3 * std::int64_t{contacts.contact[p]};
        const T* j = jacobian.data + contacts.value[p] + k;
        const T* own_response = response.data + contacts.value[p] + 3 * k;
        for (int a = 0; a < 3; ++a) {
          push += fabs(double{j[a * size]} * r[a]);
          change += fabs(double{own_response[a]} * r[a]);
        }
      }
      sum += push * change;
    }
    return {{sum}};
  }
};

/// Sums the residual of contacts [first, last).
/// @param exec  where to run
/// @param body  input
///
/// Determinism: a fixed tree, so the same bits for any number of threads; each executor has its
/// own. Cost: 9 numbers per contact.
template <class Exec, class T>
TETWARP_ANY_EXEC ContactSums contact_residual(Exec& exec,
                                              std::int64_t first,
                                              std::int64_t last,
                                              const ContactResidualOp<T>& body) {
  return exec.template sum<ContactSums>("contact/residual", first, last, body);
}

}  // namespace tetwarp

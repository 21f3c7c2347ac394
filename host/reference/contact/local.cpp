/// @file local.cpp
/// Cones by bisection, pyramids one tangent after the other.
#include "host/reference/contact/local.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "host/reference/linear/least_norm.hpp"

namespace tetwarp::reference {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {
/// Friction minus its bound, for nu and u. Of an ellipse, with both friction impulses stretched to
/// those of the disc of the larger coefficient.
double excess(const LocalContact& contact,
              const Vector3d& nu,
              const Vector3d& u,
              const ContactOptions& options) {
  const double chi = options.rule == AdhesionRule::restrictive ? 1 : 0;
  const double spring = contact.stiffness(1) * (u + contact.offset).tail<2>().norm();
  const double larger = std::max(contact.friction, contact.second_friction);
  const double bound = larger * std::max(nu(0), 0.0) - chi * spring;
  Eigen::Vector2d rub = nu.tail<2>();
  const double coefficients[] = {contact.friction, contact.second_friction};
  for (Eigen::Index a = 0; a < 2; ++a) {
    const double mu = coefficients[a];
    if (mu == larger || rub(a) == 0) continue;
    if (mu == 0) return std::numeric_limits<double>::infinity();
    rub(a) *= larger / mu;
  }
  return rub.norm() - std::max(bound, 0.0);
}

/// Impulse along tangent `a`. With p = B_aa and u0 = u - p r, the velocity with the spring but
/// without friction is h = (u0 - p kappa o) / (1 + kappa p), and friction f adds p' f to it, p' = p
/// / (1 + kappa p).
/// @param coulomb   mu times the normal impulse
/// @param impulse   r before
/// @param velocity  u before
double tangent_impulse(const LocalContact& contact,
                       Eigen::Index a,
                       double coulomb,
                       double impulse,
                       double velocity,
                       const ContactOptions& options) {
  const double chi = options.rule == AdhesionRule::restrictive ? 1 : 0;
  const double kappa = contact.stiffness(a);
  const double offset = contact.offset(a);
  const double p = contact.delassus(a, a);
  if (!(p > 0)) return impulse;
  const double u0 = velocity - p * impulse;
  const double h = (u0 - p * kappa * offset) / (1 + kappa * p);
  const double softened = p / (1 + kappa * p);
  const double sign = h < 0 ? -1 : 1;

  double friction = -h / softened;
  if (std::abs(h) > softened * std::max(coulomb - chi * kappa * std::abs(offset), 0.0)) {
    friction = -sign * coulomb;
    if (chi > 0) {
      friction = 0;
      // q is the sign of u + o; the result is valid for one q only.
      for (const double q : {1.0, -1.0}) {
        const double u = (h - sign * softened * (coulomb - q * kappa * offset)) /
                         (1 - sign * q * softened * kappa);
        const double left = coulomb - q * kappa * (u + offset);
        if (q * (u + offset) >= 0 && sign * u >= 0 && left >= 0) friction = -sign * left;
      }
    }
  }
  return (friction - kappa * (u0 + offset)) / (1 + kappa * p);
}
}  // namespace

Vector3d solve_cone(const LocalContact& contact,
                    const Vector3d& free,
                    const ContactOptions& options) {
  const Matrix3d stiffness = contact.stiffness.asDiagonal();
  const Eigen::PartialPivLU<Matrix3d> with_springs(Matrix3d::Identity() +
                                                   contact.delassus * stiffness);
  // u = compliance nu + start, with the springs eliminated.
  const Matrix3d compliance = with_springs.solve(contact.delassus);
  const Vector3d start = with_springs.solve(free - contact.delassus * (stiffness * contact.offset));
  // r = nu - K (u + o), computed without cancellation from (I + K B) r = nu - K (u0 + o).
  const auto impulse_of = [&](const Vector3d& nu) -> Vector3d {
    return (Matrix3d::Identity() + stiffness * contact.delassus)
        .partialPivLu()
        .solve(nu - stiffness * (free + contact.offset));
  };
  if (start(0) >= 0) return impulse_of(Vector3d::Zero());

  const Vector3d stick = least_norm_solution(compliance, -start);
  if (excess(contact, stick, compliance * stick + start, options) <= 0) return impulse_of(stick);

  // Sliding: nu_t = -a u_t with a = mix scale / (1 - mix); mix = 0: no friction, mix = 1: stick. On
  // an ellipse dissipation is largest for nu_a = -a mu_a^2 u_a.
  const double larger = std::max(contact.friction, contact.second_friction);
  Eigen::Vector2d share = Eigen::Vector2d::Ones();
  if (contact.friction != contact.second_friction) {
    share << contact.friction / larger, contact.second_friction / larger;
  }
  const double scale = 1 / compliance.bottomRightCorner<2, 2>().norm();
  const auto sliding = [&](double mix) -> Vector3d {
    Matrix3d matrix = compliance;
    Vector3d right = -start;
    for (Eigen::Index a = 0; a < 2; ++a) {
      const double factor = mix * scale * share(a) * share(a);
      matrix.row(1 + a) *= factor;
      right(1 + a) *= factor;
    }
    matrix(1, 1) += 1 - mix;
    matrix(2, 2) += 1 - mix;
    return matrix.partialPivLu().solve(right);
  };
  double low = 0;
  double high = 1;
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = 0.5 * (low + high);
    const Vector3d nu = sliding(middle);
    (excess(contact, nu, compliance * nu + start, options) <= 0 ? low : high) = middle;
  }
  return impulse_of(sliding(low));
}

Vector3d update_pyramid(const LocalContact& contact,
                        Vector3d impulse,
                        Vector3d velocity,
                        const ContactOptions& options) {
  const auto change = [&](Eigen::Index row, double value) {
    velocity += contact.delassus.col(row) * (value - impulse(row));
    impulse(row) = value;
  };
  const double own = contact.delassus(0, 0);
  const double gap = velocity(0) - own * impulse(0);
  const double kappa = contact.stiffness(0);
  const double preload = kappa * contact.offset(0);  // nu_n - r_n where u_n = 0
  const bool is_closed = gap - own * preload <= 0;
  change(0, is_closed ? -gap / own : -kappa * (gap + contact.offset(0)) / (1 + kappa * own));
  const double push = is_closed ? impulse(0) + preload : 0.0;
  for (Eigen::Index a = 1; a < 3; ++a) {
    const double coulomb = (a == 1 ? contact.friction : contact.second_friction) * push;
    change(a, tangent_impulse(contact, a, coulomb, impulse(a), velocity(a), options));
  }
  return impulse;
}

Vector3d update_rolling(
    const Matrix3d& delassus, Vector3d impulse, Vector3d velocity, double torsion, double rolling) {
  using Eigen::Matrix2d;
  using Eigen::Vector2d;
  const double before = impulse(0);
  if (delassus(0, 0) > 0) {
    impulse(0) = std::clamp(before - velocity(0) / delassus(0, 0), -torsion, torsion);
  }
  velocity += delassus.col(0) * (impulse(0) - before);
  const Matrix2d block = delassus.bottomRightCorner<2, 2>();
  const Vector2d start = velocity.tail<2>() - block * impulse.tail<2>();
  const Vector2d stick = least_norm_solution(block, -start);
  if (stick.norm() <= rolling || !(block.norm() > 0)) {
    impulse.tail<2>() = stick;
    return impulse;
  }
  // Rolling: m = -a omega with a = mix scale / (1 - mix), as in solve_cone().
  const double scale = 1 / block.norm();
  impulse.tail<2>().setZero();
  double low = 0, high = 1;
  for (int halving = 0; halving < 60; ++halving) {
    const double mix = 0.5 * (low + high);
    const Matrix2d matrix = mix * scale * block + (1 - mix) * Matrix2d::Identity();
    const Vector2d m = matrix.partialPivLu().solve(-mix * scale * start);
    if (m.norm() > rolling) {
      high = mix;
    } else {
      low = mix;
      impulse.tail<2>() = m;
    }
  }
  return impulse;
}

}  // namespace tetwarp::reference

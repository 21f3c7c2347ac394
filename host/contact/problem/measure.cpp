/// @file measure.cpp
#include "host/contact/problem/measure.hpp"

#include <algorithm>
#include <cmath>

namespace tetwarp {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

double entry_of(const std::vector<double>& values, std::size_t c) {
  return values.empty() ? 0.0 : values[c];
}

double largest_eigenvalue(const Eigen::Matrix2d& block) {
  const double middle = 0.5 * (block(0, 0) + block(1, 1));
  const double off = 0.5 * (block(0, 1) + block(1, 0));
  return middle + std::hypot(0.5 * (block(0, 0) - block(1, 1)), off);
}

/// e_n and e_t of natural_energy() for given rho.
Vector3d natural_map(const MeasuredContact& contact,
                     const Vector3d& impulse,
                     const Vector3d& velocity,
                     FrictionLaw law,
                     AdhesionRule rule,
                     double rho_n,
                     double rho_t) {
  const Vector3d spring = contact.stiffness.cwiseProduct(velocity + contact.offset);
  const Vector3d nu = impulse + spring;
  const double coulomb = contact.friction * std::max(nu(0), 0.0);
  const double chi = rule == AdhesionRule::restrictive ? 1.0 : 0.0;
  const Vector2d target = nu.tail<2>() - rho_t * velocity.tail<2>();
  Vector3d error;
  error(0) = std::min(nu(0), rho_n * velocity(0));
  if (law == FrictionLaw::cone) {
    const double radius = std::max(coulomb - chi * spring.tail<2>().norm(), 0.0);
    const double length = target.norm();
    error.tail<2>() = nu.tail<2>() - target * (length > radius ? radius / length : 1.0);
  } else {
    for (int a = 0; a < 2; ++a) {
      const double radius = std::max(coulomb - chi * std::abs(spring(a + 1)), 0.0);
      error(a + 1) = nu(a + 1) - std::clamp(target(a), -radius, radius);
    }
  }
  return error;
}

/// The point of { |x_t| <= mu x_n } nearest to x.
Vector3d project_on_cone(const Vector3d& x, double friction) {
  const double tangent = x.tail<2>().norm();
  // The polar cone first: without friction the cone is a ray, and an open contact lies behind it.
  if (friction * tangent <= -x(0)) return Vector3d::Zero();
  if (tangent <= friction * x(0)) return x;
  const double normal = (friction * tangent + x(0)) / (1 + friction * friction);
  const double shrink = friction * normal / tangent;
  return {normal, shrink * x(1), shrink * x(2)};
}

}  // namespace

std::vector<MeasuredContact> measured_contacts(const ContactProblem& problem) {
  const AdhesionState& adhesion = problem.adhesion;
  std::vector<MeasuredContact> contacts(problem.friction.size());
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    MeasuredContact& contact = contacts[c];
    contact.diagonal_block.setZero();
    contact.stiffness.setZero();
    contact.offset.setZero();
    contact.friction = problem.friction[c];
    const double beta = entry_of(adhesion.intensity, c);
    if (beta == 0) continue;
    const double dt = adhesion.time_step;
    const double normal = entry_of(adhesion.stiffness, c);
    const double tangent =
        adhesion.tangential_stiffness.empty() ? normal : adhesion.tangential_stiffness[c];
    const double scale = dt * dt * entry_of(adhesion.area, c) * beta * beta;
    contact.stiffness << scale * normal, scale * tangent, scale * tangent;
    if (adhesion.gap.empty()) continue;
    contact.offset << 0, adhesion.gap[3 * c + 1] / dt, adhesion.gap[3 * c + 2] / dt;
  }
  return contacts;
}

double natural_energy(const MeasuredContact& contact,
                      const Vector3d& impulse,
                      const Vector3d& velocity,
                      FrictionLaw law,
                      AdhesionRule rule) {
  const double rho_n = 1 / contact.diagonal_block(0, 0) + contact.stiffness(0);
  const double slip = largest_eigenvalue(contact.diagonal_block.bottomRightCorner<2, 2>());
  // Nothing that resists sliding may act on rows that no impulse moves: check_problem() sees to
  // that.
  const double rho_t = slip > 0 ? 1 / slip + contact.stiffness(1) : 1;
  const Vector3d error = natural_map(contact, impulse, velocity, law, rule, rho_n, rho_t);
  return error(0) * error(0) / rho_n + error.tail<2>().squaredNorm() / rho_t;
}

double fclib_square(const MeasuredContact& contact,
                    const Vector3d& impulse,
                    const Vector3d& velocity,
                    FrictionLaw law,
                    AdhesionRule rule) {
  const bool has_cone = law == FrictionLaw::cone &&
                        (rule == AdhesionRule::parallel || contact.stiffness.tail<2>().isZero(0));
  if (!has_cone) return natural_map(contact, impulse, velocity, law, rule, 1, 1).squaredNorm();
  const Vector3d nu = impulse + contact.stiffness.cwiseProduct(velocity + contact.offset);
  Vector3d target = nu - velocity;
  target(0) -= contact.friction * velocity.tail<2>().norm();
  return (nu - project_on_cone(target, contact.friction)).squaredNorm();
}

}  // namespace tetwarp

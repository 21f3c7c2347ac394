/// @file measure.cpp
/// The natural map and FCLIB's error of one contact.
#include "host/contact/problem/measure.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "host/contact/problem/friction_cone.hpp"
#include "host/contact/problem/input.hpp"

namespace tetwarp {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {
/// e_n and e_t of natural_energy() for given rho_n, rho_t, rho_t.
Vector3d natural_error(const NaturalTerms& terms, FrictionLaw law, const Vector3d& rho) {
  const Vector2d target = terms.nu.tail<2>() - rho(1) * terms.velocity.tail<2>();
  Vector3d error;
  error(0) = std::min(terms.nu(0), rho(0) * terms.velocity(0));
  if (law == FrictionLaw::cone) {
    const double radius = terms.radius(0), length = target.norm();
    error.tail<2>() = terms.nu.tail<2>() - target * (length > radius ? radius / length : 1.0);
  } else {
    for (int a = 0; a < 2; ++a) {
      error(a + 1) = terms.nu(a + 1) - std::clamp(target(a), -terms.radius(a), terms.radius(a));
    }
  }
  return error;
}

/// e of a block that is no contact, for given rho.
Vector3d row_error(const MeasuredContact& block,
                   const Vector3d& impulse,
                   const Vector3d& velocity,
                   const Vector3d& rho) {
  Vector3d stopped = rho.cwiseProduct(velocity);
  if (block.kind == ContactKind::bilateral) return stopped;
  Vector3d target = impulse - stopped;
  const double limit = block.torsion * block.push, radius = block.friction * block.push;
  target(0) = std::clamp(target(0), -limit, limit);
  const double length = target.tail<2>().norm();
  if (length > radius) target.tail<2>() *= radius / length;
  return impulse - target;
}
}  // namespace

std::vector<MeasuredContact> measured_contacts(const ContactProblem& problem) {
  std::vector<std::int32_t> index(problem.friction.size());
  std::iota(index.begin(), index.end(), 0);
  std::vector<ContactConstants<double>> constants(index.size());
  const ContactConstantsOp set_constants = {
      input_of(problem), view_of(std::as_const(index)), {.skips_rows = false}, view_of(constants)};
  std::vector<MeasuredContact> contacts(index.size());
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    set_constants(static_cast<std::int64_t>(c));
    const ContactConstants<double>& constant = constants[c];
    MeasuredContact& contact = contacts[c];
    contact.diagonal_block.setZero();
    contact.stiffness.setZero();
    contact.offset.setZero();
    contact.friction = constant.friction;
    if (!is_contact(constant.kind)) {
      contact.kind = constant.kind;
      contact.contact = problem.expert.row_blocks.contact[c];
      contact.torsion = problem.expert.row_blocks.torsion[c];
    }
    if (constant.kind != ContactKind::adhesive) continue;
    contact.stiffness << constant.normal_spring, constant.tangent_spring, constant.tangent_spring;
    contact.offset << 0, constant.tangent_offset[0], constant.tangent_offset[1];
  }
  return contacts;
}

void set_pushes(std::vector<MeasuredContact>& contacts, const Eigen::VectorXd& impulse) {
  for (MeasuredContact& contact : contacts) {
    if (contact.kind == ContactKind::rolling) {
      contact.push = std::max(impulse(3 * contact.contact), 0.0);
    }
  }
}

NaturalTerms natural_terms(const MeasuredContact& contact,
                           const Vector3d& impulse,
                           const Vector3d& velocity,
                           FrictionLaw law,
                           AdhesionRule rule) {
  const Vector3d spring = contact.stiffness.cwiseProduct(velocity + contact.offset);
  NaturalTerms terms = {velocity, impulse + spring, spring.tail<2>(), Vector2d::Zero()};
  const double coulomb = contact.friction * std::max(terms.nu(0), 0.0);
  const double chi = rule == AdhesionRule::restrictive ? 1.0 : 0.0;
  for (int a = 0; a < 2; ++a) {
    const double pull = law == FrictionLaw::cone ? terms.spring.norm() : std::abs(terms.spring(a));
    terms.radius(a) = std::max(coulomb - chi * pull, 0.0);
  }
  return terms;
}

Vector3d natural_scale(const MeasuredContact& contact) {
  if (contact.kind == ContactKind::bilateral) {
    return contact.diagonal_block.diagonal().unaryExpr([](double b) { return b > 0 ? 1 / b : 1; });
  }
  const Matrix2d block = contact.diagonal_block.bottomRightCorner<2, 2>();
  const double middle = 0.5 * block.trace();
  const double slip =
      middle + std::hypot(0.5 * (block(0, 0) - block(1, 1)), 0.5 * (block(0, 1) + block(1, 0)));
  const double rho_t = slip > 0 ? 1 / slip + contact.stiffness(1) : 1;
  const double own = contact.diagonal_block(0, 0);
  const bool is_moved = own > 0 || contact.kind != ContactKind::rolling;
  return {is_moved ? 1 / own + contact.stiffness(0) : 1, rho_t, rho_t};
}

double natural_energy(const MeasuredContact& contact,
                      const Vector3d& impulse,
                      const Vector3d& velocity,
                      FrictionLaw law,
                      AdhesionRule rule) {
  const Vector3d rho = natural_scale(contact);
  const Vector3d error =
      is_contact(contact.kind)
          ? natural_error(natural_terms(contact, impulse, velocity, law, rule), law, rho)
          : row_error(contact, impulse, velocity, rho);
  // e (e / rho) instead of e^2 / rho: the squares of very small impulses would be 0.
  return error.dot(error.cwiseQuotient(rho));
}

double fclib_square(const MeasuredContact& contact,
                    const Vector3d& impulse,
                    const Vector3d& velocity,
                    FrictionLaw law,
                    AdhesionRule rule) {
  if (!is_contact(contact.kind)) {
    return row_error(contact, impulse, velocity, Vector3d::Ones()).squaredNorm();
  }
  const NaturalTerms terms = natural_terms(contact, impulse, velocity, law, rule);
  const bool has_cone = law == FrictionLaw::cone &&
                        (rule == AdhesionRule::parallel || contact.stiffness.tail<2>().isZero(0));
  if (!has_cone) return natural_error(terms, law, Vector3d::Ones()).squaredNorm();
  Vector3d target = terms.nu - velocity;
  target(0) -= contact.friction * velocity.tail<2>().norm();
  return (terms.nu - project_on_cone(target, contact.friction)).squaredNorm();
}

}  // namespace tetwarp

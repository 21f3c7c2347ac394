/// @file natural_map.cpp
/// Values and derivatives of the natural map, contact by contact.
#include "host/contact/newton/natural_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace tetwarp {

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

NaturalMap::NaturalMap(std::vector<MeasuredContact> contacts, FrictionLaw law, AdhesionRule rule)
    : contacts_(std::move(contacts)),
      law_(law),
      rule_(rule),
      chi_(rule == AdhesionRule::restrictive ? 1.0 : 0.0),
      compliance_(3 * static_cast<Index>(contacts_.size())) {
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    compliance_.segment<3>(3 * static_cast<Index>(c)) = natural_scale(contacts_[c]).cwiseInverse();
  }
}

VectorXd NaturalMap::value(const VectorXd& impulse,
                           const VectorXd& velocity,
                           double steepness) const {
  VectorXd values(impulse.size());
  MapDerivative unused;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    const Index row = 3 * static_cast<Index>(c);
    values.segment<3>(row) =
        contact_value(c, impulse.segment<3>(row), velocity.segment<3>(row), steepness, unused);
  }
  return values.cwiseProduct((compliance_ / steepness).cwiseSqrt());
}

VectorXd NaturalMap::linearize(const VectorXd& impulse,
                               const VectorXd& velocity,
                               double steepness,
                               std::vector<MapDerivative>& derivatives) const {
  VectorXd values(impulse.size());
  derivatives.resize(contacts_.size());
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    const Index row = 3 * static_cast<Index>(c);
    MapDerivative& derivative = derivatives[c];
    const Vector3d scale = (compliance_.segment<3>(row) / steepness).cwiseSqrt();
    values.segment<3>(row) = scale.cwiseProduct(
        contact_value(c, impulse.segment<3>(row), velocity.segment<3>(row), steepness, derivative));
    // nu = r + K (u + o) depends on u, too.
    derivative.by_velocity += derivative.by_impulse * contacts_[c].stiffness.asDiagonal();
    derivative.by_impulse = scale.asDiagonal() * derivative.by_impulse;
    derivative.by_velocity = scale.asDiagonal() * derivative.by_velocity;
  }
  return values;
}

Vector3d NaturalMap::contact_value(std::size_t c,
                                   const Vector3d& impulse,
                                   const Vector3d& velocity,
                                   double steepness,
                                   MapDerivative& derivative) const {
  const MeasuredContact& contact = contacts_[c];
  const NaturalTerms terms = natural_terms(contact, impulse, velocity, law_, rule_);
  const double rho_n = steepness / compliance_(3 * static_cast<Index>(c));
  const double rho_t = steepness / compliance_(3 * static_cast<Index>(c) + 1);
  derivative.by_impulse.setZero();
  derivative.by_velocity.setZero();
  if (contact.kind == ContactKind::bilateral)
    return stop_rows(c, impulse, velocity, steepness, derivative);
  Vector3d value;
  if (terms.nu(0) > rho_n * velocity(0)) {
    value(0) = rho_n * velocity(0);
    derivative.by_velocity(0, 0) = rho_n;
  } else {
    value(0) = terms.nu(0);
    derivative.by_impulse(0, 0) = 1;
  }
  if (law_ == FrictionLaw::cone) {
    slide_on_disc(contact, terms, rho_t, value, derivative);
  } else {
    slide_on_axis(contact, terms, rho_t, 1, value, derivative);
    slide_on_axis(contact, terms, rho_t, 2, value, derivative);
  }
  return value;
}

Vector3d NaturalMap::stop_rows(std::size_t c,
                               const Vector3d& impulse,
                               const Vector3d& velocity,
                               double steepness,
                               MapDerivative& derivative) const {
  Vector3d value;
  for (int a = 0; a < 3; ++a) {
    const double rho = steepness / compliance_(3 * static_cast<Index>(c) + a);
    const bool is_empty = contacts_[c].diagonal_block(a, a) == 0;
    value(a) = is_empty ? impulse(a) : rho * velocity(a);
    (is_empty ? derivative.by_impulse : derivative.by_velocity)(a, a) = is_empty ? 1 : rho;
  }
  return value;
}

void NaturalMap::slide_on_disc(const MeasuredContact& contact,
                               const NaturalTerms& terms,
                               double rho,
                               Vector3d& value,
                               MapDerivative& derivative) const {
  const double pull = terms.spring.norm();
  const double radius = terms.radius(0);
  const Vector2d stuck = rho * terms.velocity.tail<2>();
  const Vector2d target = terms.nu.tail<2>() - stuck;
  const double length = target.norm();
  if (length <= radius) {
    value.tail<2>() = stuck;
    derivative.by_velocity.bottomRightCorner<2, 2>().diagonal().setConstant(rho);
    return;
  }
  const Vector2d along = target / length;
  value.tail<2>() = terms.nu.tail<2>() - radius * along;
  // d(R t) = t dR + (R / |z|) (I - t t^T) dz with z the target and t its direction.
  const Matrix2d across = (radius / length) * (Matrix2d::Identity() - along * along.transpose());
  derivative.by_impulse.bottomRightCorner<2, 2>() = Matrix2d::Identity() - across;
  derivative.by_velocity.bottomRightCorner<2, 2>() = rho * across;
  if (radius == 0) return;
  derivative.by_impulse.bottomLeftCorner<2, 1>() = -contact.friction * along;
  if (chi_ == 0 || pull == 0) return;
  derivative.by_velocity.bottomRightCorner<2, 2>() +=
      chi_ * contact.stiffness(1) / pull * along * terms.spring.transpose();
}

void NaturalMap::slide_on_axis(const MeasuredContact& contact,
                               const NaturalTerms& terms,
                               double rho,
                               int axis,
                               Vector3d& value,
                               MapDerivative& derivative) const {
  const double spring = terms.spring(axis - 1);
  const double radius = terms.radius(axis - 1);
  const double stuck = rho * terms.velocity(axis);
  const double target = terms.nu(axis) - stuck;
  if (std::abs(target) <= radius) {
    value(axis) = stuck;
    derivative.by_velocity(axis, axis) = rho;
    return;
  }
  const double along = std::copysign(1.0, target);
  value(axis) = terms.nu(axis) - radius * along;
  derivative.by_impulse(axis, axis) = 1;
  if (radius == 0) return;
  derivative.by_impulse(axis, 0) = -contact.friction * along;
  if (spring == 0) return;
  derivative.by_velocity(axis, axis) =
      chi_ * contact.stiffness(axis) * along * std::copysign(1.0, spring);
}

}  // namespace tetwarp

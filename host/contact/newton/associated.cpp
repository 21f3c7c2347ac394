/// @file associated.cpp
/// An interior-point method for the convex problem.
#include "host/contact/newton/associated.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace tetwarp {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using lorentz::Vector;

namespace {
constexpr int iteration_limit = 60;
constexpr double gap_goal = 1e-12;
constexpr double step_share = 0.99;  ///< of the distance to the boundary of the cones
/// Times the mean diagonal entry of the contact's block: a compliance added in the Newton steps
/// only, without which redundant contacts make the equations singular close to the solution.
constexpr double step_compliance = 1e-10;
/// Below this relative gap the iteration ends after `idle_limit` steps without improvement.
constexpr double rounding_gap = 1e-6;
constexpr int idle_limit = 4;

double compliance_of(const MeasuredContact& contact) {
  return contact.diagonal_block.trace() / 3;
}

Index row_of(std::size_t c) {
  return 3 * static_cast<Index>(c);
}
}  // namespace

AssociatedContact::AssociatedContact(const std::vector<MeasuredContact>& contacts,
                                     FrictionLaw law,
                                     const Delassus& delassus,
                                     NewtonSystem& system,
                                     SolveBudget* budget)
    : contacts_(contacts), law_(law), delassus_(delassus), system_(system), budget_(budget) {
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const double friction = contacts[c].friction, root = std::sqrt(compliance_of(contacts[c]));
    const auto add = [&](const Matrix3d& part) {
      Cone& cone = cones_.emplace_back();
      cone.contact = static_cast<Index>(c);
      cone.part = root * part;
    };
    if (friction == 0) {
      add(Vector3d(1, 0, 0).asDiagonal());
    } else if (law == FrictionLaw::cone) {
      add(Vector3d(friction, 1, 1).asDiagonal());
    } else {
      // |nu_a| <= mu nu_n for one tangent each.
      for (const int axis : {1, 2}) {
        Matrix3d part = Vector3d(friction, 0, 0).asDiagonal();
        part(1, axis) = 1;
        add(part);
      }
    }
  }
}

VectorXd AssociatedContact::lift_of(const VectorXd& velocity) const {
  VectorXd lift(static_cast<Index>(contacts_.size()));
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    const Eigen::Vector2d slip = velocity.segment<2>(row_of(c) + 1);
    lift(static_cast<Index>(c)) =
        contacts_[c].friction * (law_ == FrictionLaw::cone ? slip.norm() : slip.lpNorm<1>());
  }
  return lift;
}

VectorXd AssociatedContact::solve(const VectorXd& lift, std::int64_t step_limit) {
  start(lift);
  VectorXd best = impulse_;
  double least = std::numeric_limits<double>::infinity();
  int idle = 0;
  const std::int64_t last = std::min<std::int64_t>(step_limit, iteration_limit);
  for (std::int64_t step = 0; step < last; ++step) {
    const double mean_gap = gap();
    const double error = std::max(mean_gap / (unit_ * unit_), mismatch(lift) / unit_);
    if (!std::isfinite(error)) break;
    if (error < least) {
      least = error;
      best = impulse_;
      idle = 0;
    } else if (++idle >= idle_limit && least < rounding_gap) {
      break;
    }
    if (mean_gap < gap_goal * unit_ * unit_ || !take_step(mean_gap)) break;
  }
  return best;
}

/// One predictor-corrector step.
/// @return false  if the equations are singular or the step is not finite
bool AssociatedContact::take_step(double mean_gap) {
  is_over_ = budget_ != nullptr && !budget_->allows_newton_step();
  if (is_over_) return false;
  for (Cone& cone : cones_) cone.scaling = lorentz::scaling_of(cone.impulse, cone.velocity);
  if (!factorize()) return false;
  const auto complement = [](const Cone& cone) {
    const Vector middle = cone.scaling.forward * cone.velocity;
    return Vector(-lorentz::product(middle, middle));
  };
  if (!find_step(complement)) return false;
  const double centering = std::pow(1 - std::min(1.0, longest_step()), 3);
  const auto corrected = [&](const Cone& cone) {
    Vector target = complement(cone) - lorentz::product(cone.scaling.inverse * cone.impulse_step,
                                                        cone.scaling.forward * cone.velocity_step);
    target(0) += centering * mean_gap;
    return target;
  };
  if (!find_step(corrected)) return false;
  const double length = std::min(1.0, step_share * longest_step());
  for (Cone& cone : cones_) {
    cone.impulse += length * cone.impulse_step;
    cone.velocity += length * cone.velocity_step;
  }
  impulse_ += length * impulse_step_;
  velocity_ += length * velocity_step_;
  return true;
}

/// Starts from zero impulses and from cone variables on the axes of the cones.
void AssociatedContact::start(const VectorXd& lift) {
  impulse_ = VectorXd::Zero(row_of(contacts_.size()));
  velocity_ = delassus_.free_velocity();
  unit_ = 0;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    Vector3d lifted = velocity_.segment<3>(row_of(c));
    lifted(0) += lift(static_cast<Index>(c));
    unit_ = std::max(unit_, lifted.cwiseAbs().maxCoeff() / std::sqrt(compliance_of(contacts_[c])));
  }
  for (Cone& cone : cones_) {
    cone.impulse = unit_ * Vector::UnitX();
    cone.velocity = cone.impulse;
  }
}

Vector3d AssociatedContact::nu_of(std::size_t c) const {
  return impulse_.segment<3>(row_of(c)) +
         contacts_[c].stiffness.cwiseProduct(velocity_.segment<3>(row_of(c)) + contacts_[c].offset);
}

/// Duality gap: the mean of g . z [J].
double AssociatedContact::gap() const {
  double sum = 0;
  for (const Cone& cone : cones_) sum += cone.impulse.dot(cone.velocity);
  return sum / static_cast<double>(cones_.size());
}

/// Sets residual_ and the mismatch of each cone.
/// @return the largest residual of a row [sqrt(J)]
double AssociatedContact::mismatch(const VectorXd& lift) {
  residual_ = -velocity_;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    residual_(row_of(c)) -= lift(static_cast<Index>(c));
  }
  for (Cone& cone : cones_) {
    residual_.segment<3>(3 * cone.contact) += cone.part.transpose() * cone.velocity;
    cone.mismatch = cone.part * nu_of(static_cast<std::size_t>(cone.contact)) - cone.impulse;
  }
  double largest = 0;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    const Index used = contacts_[c].friction == 0 ? 1 : 3;
    largest = std::max(largest, residual_.segment(row_of(c), used).cwiseAbs().maxCoeff() /
                                    std::sqrt(compliance_of(contacts_[c])));
  }
  return largest;
}

/// Factorizes the equations of a step: M dnu + du = right side, dnu = dr + K du, with M the sum of
/// P^T V^-2 P over the cones of a contact. Contacts without friction have nu_t = 0 as their
/// tangential equations.
bool AssociatedContact::factorize() {
  derivatives_.assign(contacts_.size(), {Matrix3d::Zero(), Matrix3d::Zero()});
  for (const Cone& cone : cones_) {
    const Matrix3d scaled = cone.scaling.inverse * cone.part;
    derivatives_[static_cast<std::size_t>(cone.contact)].by_impulse += scaled.transpose() * scaled;
  }
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    const MeasuredContact& contact = contacts_[c];
    MapDerivative& derivative = derivatives_[c];
    const bool has_friction = contact.friction > 0;
    if (!has_friction) derivative.by_impulse.diagonal().tail<2>().setOnes();
    derivative.by_velocity = derivative.by_impulse * contact.stiffness.asDiagonal();
    derivative.by_velocity.diagonal() += has_friction ? Vector3d(1, 1, 1) : Vector3d(1, 0, 0);
    derivative.by_impulse += step_compliance * compliance_of(contact) * derivative.by_velocity;
  }
  ++iterations_;
  return system_.factorize_symmetric(derivatives_);
}

/// Finds the step by which V^-1 g o V z changes by the target, to first order.
/// @param target_of  (cone) -> target
/// @return false  if the step is not finite
template <class TargetOf>
bool AssociatedContact::find_step(const TargetOf& target_of) {
  VectorXd right_side = residual_;
  for (Cone& cone : cones_) {
    const Vector middle = cone.scaling.forward * cone.velocity;
    cone.velocity_step = cone.scaling.inverse * (lorentz::quotient(target_of(cone), middle) -
                                                 cone.scaling.inverse * cone.mismatch);
    right_side.segment<3>(3 * cone.contact) += cone.part.transpose() * cone.velocity_step;
  }
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    if (contacts_[c].friction == 0) right_side.segment<2>(row_of(c) + 1) = -nu_of(c).tail<2>();
  }
  impulse_step_ = system_.solve(right_side);
  if (!impulse_step_.allFinite()) return false;
  velocity_step_ = delassus_.velocity_change(impulse_step_);
  for (Cone& cone : cones_) {
    const Index row = 3 * cone.contact;
    const MeasuredContact& contact = contacts_[static_cast<std::size_t>(cone.contact)];
    const Vector moved =
        cone.part * (impulse_step_.segment<3>(row) +
                     contact.stiffness.cwiseProduct(velocity_step_.segment<3>(row)));
    cone.impulse_step = moved + cone.mismatch;
    cone.velocity_step -= cone.scaling.inverse * (cone.scaling.inverse * moved);
  }
  return true;
}

double AssociatedContact::longest_step() const {
  double length = std::numeric_limits<double>::infinity();
  for (const Cone& cone : cones_) {
    length = std::min({length, lorentz::distance_to_boundary(cone.impulse, cone.impulse_step),
                       lorentz::distance_to_boundary(cone.velocity, cone.velocity_step)});
  }
  return length;
}

}  // namespace tetwarp

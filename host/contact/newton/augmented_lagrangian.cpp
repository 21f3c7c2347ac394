/// @file augmented_lagrangian.cpp
/// Newton's method in velocities, its line search, and the steps of the multipliers.
#include "host/contact/newton/augmented_lagrangian.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "host/contact/newton/dense_bodies.hpp"
#include "host/contact/problem/friction_cone.hpp"
#include "host/contact/problem/measure.hpp"

namespace tetwarp {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {
// Constants found by experiment on stacks of boxes with masses 3^n at rest.
constexpr std::int64_t most_dofs = 72;
/// Compliance of a contact relative to its own. A smaller one takes more Newton steps, a greater
/// one more steps of the multipliers, which do not end far below it.
constexpr double first_softness = 1e-4, least_softness = 1e-8;
constexpr double softness_drop = 0.2;  ///< after few Newton steps, once eta is near
constexpr double near_error = 3e-6;    ///< eta
/// Of the allowed error: a better end is a better start of the next step.
constexpr double share_of_allowed = 0.5;
constexpr std::int64_t patience = 15;  ///< Newton steps without half of the error
constexpr int few_steps = 3;
constexpr int minimize_limit = 8;     ///< Newton steps per step of the multipliers
constexpr double energy_drop = 0.01;  ///< of the gradient, in these
constexpr std::int64_t newton_limit = 40;
constexpr int search_limit = 14;  ///< halvings of the length of one Newton step

class AugmentedLagrangian {
 public:
  AugmentedLagrangian(const ContactProblem& problem,
                      const ContactOptions& options,
                      const StopCriterion& criterion,
                      SolveBudget* budget)
      : bodies_(problem, options.recovery_speed),
        contacts_(measured_contacts(problem)),
        criterion_(criterion),
        budget_(budget),
        slope_(contacts_.size()) {
    spring_free_ = std::ranges::all_of(
        contacts_, [](const MeasuredContact& contact) { return contact.stiffness.isZero(0); });
    for (std::size_t c = 0; c < contacts_.size(); ++c) {
      contacts_[c].diagonal_block = bodies_.diagonal_block(c);
      mass_.push_back(3 / contacts_[c].diagonal_block.trace() + contacts_[c].stiffness.maxCoeff());
    }
    free_velocity_ = bodies_.solve(bodies_.load());
  }

  void run(const VectorXd& start);

  const VectorXd& best() const { return best_; }
  double excess() const { return excess_; }
  std::int64_t steps() const { return steps_; }

 private:
  /// Impulses and velocities of the bodies.
  struct Iterate {
    VectorXd impulse;   ///< r, [3 contacts]
    VectorXd velocity;  ///< v, [dofs]
  };
  /// The function that is minimized, at a v.
  struct Point {
    VectorXd velocity;  ///< v
    double value = 0;   ///< [J]
    VectorXd gradient;  ///< A v - b - J^T r
    VectorXd push;      ///< P, the next nu, [3 contacts]
    VectorXd impulse;   ///< r = P - K (u + o), [3 contacts]
  };

  Point point_at(VectorXd velocity);
  void minimize(Point& point);
  bool step(Point& point);
  void set_multipliers(const Point& point);
  double natural_square(const Iterate& iterate) const;
  void measure(const Point& point);
  bool is_settled() const;

  DenseBodies bodies_;
  std::vector<MeasuredContact> contacts_;
  StopCriterion criterion_;
  SolveBudget* budget_;
  bool spring_free_ = true;
  std::vector<double> mass_;  ///< rho at a softness of 1 [kg]
  VectorXd free_velocity_;    ///< A^-1 b
  VectorXd multiplier_;       ///< nu of the last step, [3 contacts]
  std::vector<double> lift_;  ///< s [m/s]
  double softness_ = first_softness;
  std::vector<Matrix3d> slope_;  ///< derivative of P at the last point
  MatrixXd hessian_;
  Eigen::LLT<MatrixXd> factor_;
  VectorXd best_;                                            ///< impulses
  double excess_ = std::numeric_limits<double>::infinity();  ///< error over allowed error of best_
  double halved_ = excess_;                                  ///< the error that has to be halved
  std::int64_t steps_ = 0, halved_at_ = 0;
  bool is_over_ = false;
};

AugmentedLagrangian::Point AugmentedLagrangian::point_at(VectorXd velocity) {
  Point out;
  out.velocity = std::move(velocity);
  const VectorXd momentum = bodies_.system() * out.velocity;
  out.value = out.velocity.dot(0.5 * momentum - bodies_.load());
  out.push.resize(3 * std::ssize(contacts_));
  out.impulse.resize(out.push.size());
  out.gradient = momentum - bodies_.load();
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    const MeasuredContact& contact = contacts_[c];
    const Index row = 3 * static_cast<Index>(c);
    const double rho = mass_[c] / softness_;
    const Vector3d u = bodies_.contact_velocity(c, out.velocity);
    Vector3d target = multiplier_.segment<3>(row) - rho * u;
    target(0) -= rho * lift_[c];
    const Vector3d push = project_on_cone(target, contact.friction, &slope_[c]);
    const Vector3d stretch = u + contact.offset;
    const Vector3d impulse = push - contact.stiffness.cwiseProduct(stretch);
    out.value += push.squaredNorm() / (2 * rho);
    if (!spring_free_) out.value += stretch.dot(contact.stiffness.cwiseProduct(stretch)) / 2;
    out.push.segment<3>(row) = push;
    out.impulse.segment<3>(row) = impulse;
    bodies_.add_push(c, -impulse, out.gradient);
  }
  return out;
}

/// Sum of the natural energies of all contacts.
double AugmentedLagrangian::natural_square(const Iterate& iterate) const {
  double sum = 0;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    sum += natural_energy(contacts_[c], iterate.impulse.segment<3>(3 * static_cast<Index>(c)),
                          bodies_.contact_velocity(c, iterate.velocity), FrictionLaw::cone,
                          AdhesionRule::parallel);
  }
  return sum;
}

/// Measures the impulses of a point with the velocities that they cause, and keeps the best.
void AugmentedLagrangian::measure(const Point& point) {
  Iterate iterate{point.impulse, point.velocity - bodies_.solve(point.gradient)};
  VectorXd push = VectorXd::Zero(iterate.velocity.size()), sizes = push;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    const Vector3d impulse = iterate.impulse.segment<3>(3 * static_cast<Index>(c));
    bodies_.add_push(c, impulse, push);
    bodies_.add_push_size(c, impulse, sizes);
  }
  ContactSums sums;
  sums.eta = natural_square(iterate);
  sums.work = push.dot(iterate.velocity - free_velocity_);
  sums.magnitude = sizes.dot(bodies_.solve(sizes));
  const double excess = criterion_.excess_of(sums);
  if (!(excess < excess_)) return;
  if (excess <= halved_ / 2) {
    halved_ = excess;
    halved_at_ = steps_;
  }
  excess_ = excess;
  best_ = std::move(iterate.impulse);
}

bool AugmentedLagrangian::is_settled() const {
  return is_over_ || steps_ >= newton_limit || steps_ - halved_at_ >= patience ||
         excess_ <= share_of_allowed;
}

/// One Newton step from a point. @returns whether the value has dropped
bool AugmentedLagrangian::step(Point& point) {
  is_over_ = budget_ != nullptr && !budget_->allows_newton_step();
  if (is_over_) return false;
  ++steps_;
  hessian_ = bodies_.system();
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    Matrix3d response = (mass_[c] / softness_) * slope_[c];
    response.diagonal() += contacts_[c].stiffness;
    if (!response.isZero(0)) bodies_.add_response(c, response, hessian_);
  }
  factor_.compute(hessian_);
  if (factor_.info() != Eigen::Success) return false;
  const VectorXd direction = -factor_.solve(point.gradient);
  const double slope = point.gradient.dot(direction);
  if (!(slope <= 0)) return false;
  double length = 1;
  for (int halving = 0; halving < search_limit; ++halving, length /= 2) {
    Point next = point_at(point.velocity + length * direction);
    if (next.value <= point.value + 1e-4 * length * slope + 1e-12 * std::abs(point.value)) {
      point = std::move(next);
      return true;
    }
  }
  return false;
}

/// Newton steps until the gradient has dropped, or none drops the value.
void AugmentedLagrangian::minimize(Point& point) {
  const auto energy = [&] { return point.gradient.dot(bodies_.solve(point.gradient)); };
  const double goal = energy_drop * energy();
  for (int taken = 1; taken <= minimize_limit && !is_settled() && step(point); ++taken) {
    measure(point);
    if (energy() > goal) continue;
    if (taken <= few_steps && excess_ * criterion_.tolerance <= near_error) {
      softness_ = std::max(softness_drop * softness_, least_softness);
    }
    return;
  }
  softness_ = std::min(softness_ / softness_drop, first_softness);
}

void AugmentedLagrangian::set_multipliers(const Point& point) {
  multiplier_ = point.push;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    const Vector3d u = bodies_.contact_velocity(c, point.velocity);
    lift_[c] = contacts_[c].friction * u.tail<2>().norm();
  }
}

void AugmentedLagrangian::run(const VectorXd& start) {
  best_ = start;
  VectorXd push = bodies_.load();
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    bodies_.add_push(c, start.segment<3>(3 * static_cast<Index>(c)), push);
  }
  Point point;
  point.velocity = bodies_.solve(push);
  point.push = start;
  lift_.resize(contacts_.size());
  if (!spring_free_) {
    for (std::size_t c = 0; c < contacts_.size(); ++c) {
      const Vector3d u = bodies_.contact_velocity(c, point.velocity);
      point.push.segment<3>(3 * static_cast<Index>(c)) +=
          contacts_[c].stiffness.cwiseProduct(u + contacts_[c].offset);
    }
  }
  while (!is_settled()) {
    set_multipliers(point);
    point = point_at(std::move(point.velocity));
    if (!std::isfinite(point.value)) return;
    minimize(point);
  }
}
}  // namespace

bool takes_multipliers(const ContactProblem& problem,
                       const ContactOptions& options,
                       std::int64_t dofs) {
  return !problem.is_local() && dofs <= most_dofs && options.max_newton > 0 &&
         problem.expert.row_blocks.empty() && options.law == FrictionLaw::cone &&
         options.rule == AdhesionRule::parallel && options.measure == ContactMeasure::eta;
}

/// Measured on stacks: a step takes two sweeps, and a factorization.
double sweeps_per_multiplier_step(std::int64_t dofs, std::int64_t contacts) {
  constexpr double updates_per_entry = 1.0 / 600;
  const auto size = static_cast<double>(dofs);
  return 2 + updates_per_entry * size * size * size / static_cast<double>(contacts);
}

NewtonResult solve_by_multipliers(const ContactProblem& problem,
                                  const ContactOptions& options,
                                  const StopCriterion& criterion,
                                  std::vector<double>& impulse,
                                  SolveBudget* budget) {
  if (budget != nullptr) {
    if (budget->is_over()) return {};
    budget->start_newton();
  }
  AugmentedLagrangian method(problem, options, criterion, budget);
  method.run(Eigen::Map<const VectorXd>(impulse.data(), std::ssize(impulse)));
  impulse.assign(method.best().begin(), method.best().end());
  return {.iterations = method.steps(), .converged = method.excess() <= 1};
}

}  // namespace tetwarp

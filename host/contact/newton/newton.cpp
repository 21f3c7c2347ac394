/// @file newton.cpp
/// The phases of Newton's method, its starts and its line search.
#include "host/contact/newton/newton.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "host/contact/newton/associated.hpp"
#include "host/contact/newton/natural_map.hpp"
#include "host/contact/newton/newton_system.hpp"
#include "host/contact/problem/delassus.hpp"
#include "host/contact/problem/measure.hpp"

namespace tetwarp {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {
// Constants found by experiment on stacks, packings and problems recorded in other simulators, also
// with fewer contacts, in other orders, and with other friction and loads.
constexpr double first_epsilon = 1e-3;
constexpr double min_epsilon = 1e-12;
constexpr double max_epsilon = 100;
constexpr double epsilon_drop = 0.3;
constexpr double rounding_error = 1e-13;
constexpr int inner_limit = 12;     ///< Newton steps per proximal point
constexpr int halving_limit = 12;   ///< of the length of one Newton step
constexpr int hold_after_miss = 3;  ///< proximal points after a failure before epsilon may drop
/// The steepness of the map is epsilon^-p; after each proximal point that Newton's method does not
/// find, the other p is used.
constexpr double steepness_powers[] = {0.5, 0.75};
/// The first proximal points end after this many linear systems during which the error has not
/// halved: what follows does not depend on them.
constexpr std::int64_t first_patience = 10;
/// Start of epsilon, and linear systems at most, from the solution of an associated problem.
constexpr double lift_epsilon = 1e-6;
constexpr std::int64_t lift_steps = 10;
/// Proximal points that reduce the error of an associated solution by this factor give the next
/// lift, too.
constexpr double lift_gain = 0.3;
constexpr std::int64_t endless_patience = std::numeric_limits<std::int64_t>::max();

/// Impulses, the velocities they cause, and the residuals of both.
struct Iterate {
  VectorXd impulse;
  VectorXd velocity;
  double eta = 0;
  double fclib = 0;
};

/// State of a proximal point iteration, which advance() continues.
struct Approach {
  Iterate center;
  double epsilon = first_epsilon;
  int misses = 0;  ///< proximal points not found
  int hold = 0;    ///< proximal points until epsilon may drop
};

class NewtonPolish {
 public:
  NewtonPolish(const ContactProblem& problem,
               const ContactOptions& options,
               const Delassus& delassus,
               SolveBudget* budget)
      : options_(options),
        delassus_(delassus),
        budget_(budget),
        contacts_(make_contacts(problem, delassus)),
        map_(contacts_, options.law, options.rule),
        system_(problem, delassus),
        has_only_contacts_(problem.expert.row_blocks.empty()) {
    const VectorXd none = VectorXd::Zero(delassus.free_velocity().size());
    free_energy_ = map_.value(none, delassus.free_velocity(), 1).squaredNorm();
  }

  void run(const VectorXd& start, const NewtonLimits& limits);

  const Iterate& best() const { return best_; }
  bool is_done(const Iterate& iterate) const { return error_of(iterate) <= options_.tolerance; }
  std::int64_t iterations() const { return iterations_; }

 private:
  Iterate make_iterate(const VectorXd& impulse) const {
    const VectorXd change = delassus_.velocity_change(impulse);
    Iterate iterate{impulse, change + delassus_.free_velocity(), 0, 0};
    const double magnitude = delassus_.magnitude(impulse);
    const double scale =
        std::sqrt(free_energy_) + std::sqrt(resolved_energy(impulse.dot(change), magnitude));
    // Rounding of the velocities: a smaller residual is not resolved.
    const double error = std::hypot(residual_of(iterate), 0x1p-53 * std::sqrt(magnitude));
    iterate.eta = relative_error(error, scale);
    double square = 0;
    for (std::size_t c = 0; c < contacts_.size(); ++c) {
      const Index row = 3 * static_cast<Index>(c);
      square += fclib_square(contacts_[c], impulse.segment<3>(row),
                             iterate.velocity.segment<3>(row), options_.law, options_.rule);
    }
    iterate.fclib = relative_error(std::sqrt(square), delassus_.free_velocity().norm());
    return iterate;
  }

  double error_of(const Iterate& iterate) const {
    return options_.measure == ContactMeasure::eta ? iterate.eta : iterate.fclib;
  }

  /// The best iterate is within the tolerance, its error is rounding, or no steps are left.
  bool is_settled() const {
    return is_over_ || iterations_ >= total_limit_ || is_done(best_) ||
           error_of(best_) < rounding_error;
  }

  void keep(const Iterate& iterate) {
    if (error_of(iterate) < error_of(best_)) best_ = iterate;
  }

  static std::vector<MeasuredContact> make_contacts(const ContactProblem& problem,
                                                    const Delassus& delassus) {
    std::vector<MeasuredContact> contacts = measured_contacts(problem);
    const std::vector<Eigen::Matrix3d> blocks = delassus.diagonal_blocks();
    for (std::size_t c = 0; c < contacts.size(); ++c) contacts[c].diagonal_block = blocks[c];
    return contacts;
  }

  double residual_of(const Iterate& iterate) const {
    return map_.value(iterate.impulse, iterate.velocity, 1).norm();
  }

  /// Finds proximal points until the problem is solved or `limit` linear systems were solved.
  /// @param patience  linear systems without half of the error after which it ends
  void advance(Approach& approach, std::int64_t limit, std::int64_t patience = endless_patience);

  /// De Saxce's fixed point iteration on the lifts: solves a series of convex problems and
  /// continues from each solution with proximal points.
  /// @param limit  linear systems at most
  void solve_associated(std::int64_t limit);

  /// Newton steps on F(r, u + epsilon / rho (r - center)) = 0 from the center.
  /// @param pull     epsilon / rho of every row
  /// @param iterate  in: the center; out: the proximal point
  /// @return whether |F| has dropped to a tenth, or an iterate solves the whole problem
  bool find_proximal_point(const VectorXd& pull, double steepness, Iterate& iterate);

  const ContactOptions& options_;
  const Delassus& delassus_;
  SolveBudget* budget_;
  bool is_over_ = false;  ///< the budget allows no more steps
  const std::vector<MeasuredContact> contacts_;
  const NaturalMap map_;
  NewtonSystem system_;
  std::vector<MapDerivative> derivatives_;
  bool has_only_contacts_;  ///< without bilateral blocks, which associated problems do not have
  double free_energy_ = 0;
  Iterate best_;
  std::int64_t iterations_ = 0;
  std::int64_t total_limit_ = NewtonLimits::none;  ///< of iterations_
};

void NewtonPolish::run(const VectorXd& start, const NewtonLimits& limits) {
  best_ = make_iterate(start);
  total_limit_ = limits.total;
  const std::int64_t limit = std::min(limits.shared, max_newton_steps(std::ssize(contacts_)));
  Approach approach{.center = best_};
  if (limits.phases != NewtonPhases::far) advance(approach, limit / 4, first_patience);
  if (limits.phases == NewtonPhases::near || is_settled()) return;
  if (has_only_contacts_) solve_associated(limit - limit / 4);
  if (is_settled()) return;
  advance(approach, limit - limit / 4);
  if (is_settled()) return;
  Approach again{.center = best_};
  advance(again, limit / 2);
}

void NewtonPolish::advance(Approach& approach, std::int64_t limit, std::int64_t patience) {
  double& epsilon = approach.epsilon;
  int idle = 0;
  const std::int64_t end = std::min(iterations_ + limit, total_limit_);
  double halved = error_of(best_) / 2;
  std::int64_t halved_at = iterations_;
  while (!is_over_ && !is_done(best_) && iterations_ < end) {
    if (error_of(best_) <= halved) {
      halved = error_of(best_) / 2;
      halved_at = iterations_;
    }
    if (iterations_ - halved_at >= patience) return;
    const double best_before = error_of(best_);
    const double steepness = std::pow(epsilon, -steepness_powers[approach.misses % 2]);
    Iterate iterate = approach.center;
    const std::int64_t before = iterations_;
    if (find_proximal_point(epsilon * map_.compliance(), steepness, iterate)) {
      approach.center = std::move(iterate);
      if (approach.hold > 0) {
        --approach.hold;
      } else if (iterations_ - before <= 8) {
        epsilon *= iterations_ - before <= 3 ? epsilon_drop : std::sqrt(epsilon_drop);
        epsilon = std::max(epsilon, min_epsilon);
      }
    } else {
      ++approach.misses;
      approach.hold = hold_after_miss;
      epsilon = std::min(epsilon / epsilon_drop, max_epsilon);
    }
    idle = error_of(best_) < 0.9 * best_before ? 0 : idle + 1;
    if (best_.eta < rounding_error && idle > 5) return;
  }
}

void NewtonPolish::solve_associated(std::int64_t limit) {
  AssociatedContact associated(contacts_, options_.law, delassus_, system_, budget_);
  VectorXd lift = VectorXd::Zero(static_cast<Index>(contacts_.size()));
  const std::int64_t end = std::min(iterations_ + limit, total_limit_);
  while (!is_settled() && iterations_ < end) {
    const std::int64_t before = associated.iterations();
    Approach approach{.center = make_iterate(associated.solve(lift, total_limit_ - iterations_)),
                      .epsilon = lift_epsilon};
    iterations_ += associated.iterations() - before;
    is_over_ = associated.is_over();
    keep(approach.center);
    const double error = error_of(approach.center);
    lift = associated.lift_of(approach.center.velocity);
    advance(approach, lift_steps);
    if (error_of(approach.center) < lift_gain * error) {
      lift = associated.lift_of(approach.center.velocity);
    }
  }
}

bool NewtonPolish::find_proximal_point(const VectorXd& pull, double steepness, Iterate& iterate) {
  const VectorXd center = iterate.impulse;
  const auto pulled = [&](const VectorXd& impulse, const VectorXd& velocity) {
    return VectorXd(velocity + pull.cwiseProduct(impulse - center));
  };
  double norm = map_.value(iterate.impulse, iterate.velocity, steepness).norm();
  const double goal = 0.1 * norm;
  for (int step = 0; step < inner_limit; ++step) {
    const VectorXd residual = map_.linearize(
        iterate.impulse, pulled(iterate.impulse, iterate.velocity), steepness, derivatives_);
    for (std::size_t c = 0; c < derivatives_.size(); ++c) {
      derivatives_[c].by_impulse +=
          derivatives_[c].by_velocity * pull.segment<3>(3 * static_cast<Index>(c)).asDiagonal();
    }
    is_over_ = budget_ != nullptr && !budget_->allows_newton_step();
    if (is_over_) return false;
    ++iterations_;
    if (!system_.factorize(derivatives_)) return false;
    const VectorXd impulse_step = system_.solve(-residual);
    if (!impulse_step.allFinite()) return false;
    const VectorXd velocity_step = delassus_.velocity_change(impulse_step);
    double length = 1;
    double next = 0;
    for (int halving = 0;; ++halving, length /= 2) {
      if (halving == halving_limit) return false;
      const VectorXd impulse = iterate.impulse + length * impulse_step;
      next =
          map_.value(impulse, pulled(impulse, iterate.velocity + length * velocity_step), steepness)
              .norm();
      if (next <= (1 - 1e-4 * length) * norm) break;
    }
    norm = next;
    iterate = make_iterate(iterate.impulse + length * impulse_step);
    keep(iterate);
    if (norm <= goal || is_done(iterate)) return true;
  }
  return false;
}
}  // namespace

std::int64_t max_newton_steps(std::int64_t contacts) {
  return std::clamp<std::int64_t>(250000 / (contacts + 1), 50, 1000);
}

NewtonResult newton_polish(const ContactProblem& problem,
                           const ContactOptions& options,
                           std::vector<double>& impulse,
                           std::vector<double>& body_velocity,
                           SolveBudget* budget,
                           const NewtonLimits& limits) {
  if (budget != nullptr) {
    const bool fits = budget->allows_memory(newton_cost(problem, budget->memory_limit()).bytes);
    if (!fits || budget->is_over()) return {};
    budget->start_newton();
  }
  const Delassus delassus(problem, options.recovery_speed);
  VectorXd start = VectorXd::Zero(3 * static_cast<Index>(problem.contact_count()));
  if (!impulse.empty()) {
    start = Eigen::Map<const VectorXd>(impulse.data(), static_cast<Index>(impulse.size()));
  }
  NewtonPolish polish(problem, options, delassus, budget);
  polish.run(start, limits);
  const Iterate& best = polish.best();
  impulse.assign(best.impulse.begin(), best.impulse.end());
  const VectorXd v = delassus.body_velocity(best.impulse);
  body_velocity.assign(v.begin(), v.end());
  return {polish.iterations(), best.eta, best.fclib, polish.is_done(best)};
}

}  // namespace tetwarp

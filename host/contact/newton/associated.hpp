/// @file associated.hpp
/// Contact with associated friction: a convex problem that yields starts for Newton's method.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact/newton/lorentz_cone.hpp"
#include "host/contact/newton/newton_system.hpp"
#include "host/contact/problem/budget.hpp"
#include "host/contact/problem/delassus.hpp"
#include "host/contact/problem/measure.hpp"

namespace tetwarp {

/// With nu = r + K (u + o), u = B r + q, a lift s >= 0 and K' the friction cone or pyramid:
///
///     nu in K',   y = u + s n in its dual cone,   nu . y = 0   at every contact
///
/// The problem is convex, and u is unique even where impulses are not. If s = mu |u_t| (pyramid:
/// mu (|u_1| + |u_2|)), its solutions are those of Coulomb's law with AdhesionRule::parallel; s = 0
/// is exact where no contact slides.
///
/// Source: De Saxce, Feng 1998 (the lift); Nesterov, Todd 1998; Mehrotra 1992.
class AssociatedContact {
 public:
  /// @param contacts  with their diagonal blocks
  /// @param budget    ends the iteration; null: no limits
  /// All references must be valid as long as this object.
  AssociatedContact(const std::vector<MeasuredContact>& contacts,
                    FrictionLaw law,
                    const Delassus& delassus,
                    NewtonSystem& system,
                    SolveBudget* budget = nullptr);

  /// Finds the impulses [N s], [3 contacts], by a primal-dual interior point method.
  ///
  /// Rounding ends the iteration at a duality gap of 1e-6 to 1e-12 relative to the energy of the
  /// free motion, so that the result is close to a solution only.
  /// @param lift  s, [contacts], m/s
  /// @param step_limit  linear systems at most
  Eigen::VectorXd solve(const Eigen::VectorXd& lift,
                        std::int64_t step_limit = std::numeric_limits<std::int64_t>::max());

  /// The impulses of the last step of the last solve(). Where no impulses solve the problem, they
  /// have grown along a direction that causes no velocity.
  const Eigen::VectorXd& last_impulse() const { return impulse_; }

  /// The s for which these velocities, [3 contacts], obey Coulomb's law.
  Eigen::VectorXd lift_of(const Eigen::VectorXd& velocity) const;

  /// Linear systems solved so far, by all calls of solve().
  std::int64_t iterations() const { return iterations_; }

  /// Whether the budget ended the last call of solve().
  bool is_over() const { return is_over_; }

 private:
  /// g = P nu and z, both in a Lorentz cone [sqrt(J)]; y of a contact is the sum of P^T z over its
  /// cones: one, with the pyramid one per tangent.
  struct Cone {
    Eigen::Index contact;
    Eigen::Matrix3d part;      ///< P [1/sqrt(kg)]
    lorentz::Vector impulse;   ///< g
    lorentz::Vector velocity;  ///< z
    lorentz::Vector impulse_step;
    lorentz::Vector velocity_step;
    lorentz::Vector mismatch;  ///< P nu - g
    lorentz::Scaling scaling;
  };

  void start(const Eigen::VectorXd& lift);
  double gap() const;
  double mismatch(const Eigen::VectorXd& lift);
  bool take_step(double mean_gap);
  bool factorize();
  template <class TargetOf>
  bool find_step(const TargetOf& target_of);
  double longest_step() const;
  Eigen::Vector3d nu_of(std::size_t c) const;

  const std::vector<MeasuredContact>& contacts_;
  FrictionLaw law_;
  const Delassus& delassus_;
  NewtonSystem& system_;
  std::vector<Cone> cones_;
  std::vector<MapDerivative> derivatives_;
  Eigen::VectorXd impulse_;
  Eigen::VectorXd velocity_;
  Eigen::VectorXd impulse_step_;
  Eigen::VectorXd velocity_step_;
  Eigen::VectorXd residual_;  ///< P^T z - (u + s n)
  double unit_ = 0;           ///< root of the energy scale of the free motion [sqrt(J)]
  std::int64_t iterations_ = 0;
  SolveBudget* budget_;
  bool is_over_ = false;
};

}  // namespace tetwarp

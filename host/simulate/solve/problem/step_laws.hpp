/// @file step_laws.hpp
/// StepLaws: friction, offsets, adhesion and guess of the contacts of a step.
#pragma once
#include <vector>

#include <tetwarp/contact_problem.hpp>
#include <tetwarp/contact_tracker.hpp>

#include "host/simulate/solve/problem/step_rows.hpp"

namespace tetwarp {

class StepLaws {
 public:
  /// @param scene              kept by the caller
  /// @param recovery_fraction  see ContactSystemOptions
  StepLaws(const SceneSurfaces& scene, double recovery_fraction)
      : scene_(scene), recovery_fraction_(recovery_fraction) {}

  /// Sets the laws of all contacts. Adds the velocities of prescribed blocks to the offsets, and
  /// raises normal offsets so that existing penetration recovers at most at the speed of
  /// recovery_fraction.
  /// @param rows      of all contacts with prescribed blocks
  /// @param velocity  [block_count]
  void set(const ContactTracker& tracker,
           const std::vector<TrackedContact>& contacts,
           const StepRows& rows,
           const std::vector<Point3>& velocity);
  /// Keeps the impulses of the contacts of the last set(): they are the guess for contacts with the
  /// same keys in those that follow, until forget_impulses().
  /// @param impulse  [3 contacts], along their axes
  void keep_impulses(const std::vector<TrackedContact>& contacts,
                     const std::vector<double>& impulse);
  void forget_impulses() { kept_.clear(); }

  /// The laws as a problem without matrices.
  const ContactProblem& problem() const { return laws_; }
  /// [contacts] what was added to the normal offset [m/s]: to slow down recovery, or for bonds of
  /// surfaces that do not touch.
  const std::vector<double>& recovered() const { return recovered_; }

 private:
  struct KeptImpulse {
    ContactKey key;
    Point3 impulse;  ///< [world]
  };

  void set_guess(const std::vector<TrackedContact>& contacts);
  void set_bond(const TrackedContact& contact, std::size_t c);
  double recovery_speed(const ContactKey& key) const;

  const SceneSurfaces& scene_;
  double recovery_fraction_;
  ContactProblem laws_;
  std::vector<double> recovered_;
  std::vector<KeptImpulse> kept_;  ///< sorted by key
};

}  // namespace tetwarp

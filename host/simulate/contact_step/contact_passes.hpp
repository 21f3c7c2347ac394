/// @file contact_passes.hpp
/// ContactPasses: finds and solves the contacts of a part of a step.
#pragma once
#include <cstddef>

#include <tetwarp/simulate.hpp>

#include "host/collide/detector.hpp"
#include "host/simulate/contact_step/contact_history.hpp"
#include "host/simulate/contact_step/contact_part.hpp"
#include "host/simulate/contact_step/contact_step_options.hpp"
#include "host/simulate/contact_step/part_motion.hpp"
#include "host/simulate/patches/pair_contacts.hpp"
#include "host/simulate/solve/contact_system.hpp"

namespace tetwarp {

/// What passes read and change; members are kept by the caller.
struct PassParts {
  const Scene& scene;
  const Model& model;
  const SceneSurfaces& surfaces;
  Detector& detector;
  ContactHistory& history;
  PartMotion& motion;
};

/// A pass is a detection along the motion and a solve of all contacts found so far, which makes
/// another motion. Passes end when a detection finds nothing new, or at SceneSolver::max_passes.
class ContactPasses {
 public:
  ContactPasses(const PassParts& parts, const ContactStepOptions& options);

  /// Replaces the velocities of the motion by those with contact, and leaves the motion that they
  /// make.
  /// @param is_first  whether it is the first part of a simulation, in which surfaces that are near
  ///                  have their initial adhesion
  void run(bool is_first, BodyStepper& stepper, ContactPart& part);
  /// Whether a detection of the last run() has found any pairs, or none has seen its motion.
  bool has_pairs() const { return has_pairs_; }
  /// With the last solve.
  const ContactSystem& system() const { return system_; }

 private:
  bool is_late() const;
  bool expect_contacts_of_last_step();
  bool detect(std::size_t pass, bool is_expected, ContactPart& part);
  void track(bool is_first);
  bool solve(BodyStepper& stepper, ContactPart& part);

  PassParts parts_;
  ContactStepOptions options_;
  PairContacts pair_contacts_;
  ContactSystem system_;
  bool was_ended_ = false;  ///< by progress
  bool has_pairs_ = false;
};

}  // namespace tetwarp

/// @file step_sums.hpp
/// Impulses on bodies and work in a step, summed over its parts.
#pragma once
#include <vector>

#include "host/simulate/model/model.hpp"
#include "host/simulate/step/stepper.hpp"

namespace tetwarp {

/// Impulses [N s], per body of the scene.
struct StepSums {
  std::vector<Point3> support;   ///< that moved fixed, driven and scripted blocks as prescribed
  std::vector<Point3> handle;    ///< of springs of handles
  std::vector<Point3> coupling;  ///< of springs of couplings, on either side
  std::vector<Point3> load;
  std::vector<Point3> contact;   ///< of contacts, adhesion included
  std::vector<Point3> obstacle;  ///< [obstacles] of contacts
  std::vector<Point3> on_a;      ///< [couplings], on their body a
  double work = 0;               ///< by scripts, anchors and loads [J]

  void reset(std::size_t body_count, std::size_t obstacle_count, std::size_t coupling_count);
  /// Adds the contacts of a part of a step.
  /// @param on_bodies  impulses [bodies, then obstacles]
  void add_contacts(const std::vector<Point3>& on_bodies);
};

/// Adds a part of a step. With damping alpha = 0 the impulses are those of the linear system, so
/// that a body's momentum changes by them and by gravity, to rounding.
/// @param before, after  states at its ends
/// @param supports       BodyStepper::support_impulses() without those of contacts
void add_step(const Model& model,
              const ModelState& before,
              const ModelState& after,
              const StepInput& input,
              const std::vector<Point3>& supports,
              StepSums& sums);

}  // namespace tetwarp

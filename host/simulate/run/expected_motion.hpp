/// @file expected_motion.hpp
/// What the contacts of the step before let one expect of the next step.
#pragma once
#include <vector>

#include "host/simulate/model/model.hpp"

namespace tetwarp {

/// Adds the changes of the step before to the velocities of bodies whose contacts are expected to
/// act as in that step. These are the bodies that keep their velocity better with the changes than
/// without: those at rest or sliding, not those that have just had an impact.
/// @param start     state at the start of the step
/// @param change    by how much contacts changed the velocities in the step before, [block_count]
///                  [m/s, rad/s]
/// @param velocity  in: without contact, [block_count] [m/s, rad/s]; out: expected
void expect_contacts(const Model& model,
                     const ModelState& start,
                     const std::vector<Point3>& change,
                     std::vector<Point3>& velocity);

}  // namespace tetwarp

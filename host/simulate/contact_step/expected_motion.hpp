/// @file expected_motion.hpp
/// Velocities with the contacts of the last step, as a guess for those of this step.
#pragma once
#include <vector>

#include "host/simulate/model/model.hpp"

namespace tetwarp {

/// Adds the changes of the last step to the velocities of the bodies that keep their velocity
/// better with these changes than without. These are bodies at rest or sliding, not those that had
/// an impact in the last step: its changes do not come again.
/// @param start     state at the start of the step
/// @param change    by how much contacts changed the velocities in the last step, [block_count]
///                  [m/s, rad/s]
/// @param velocity  in: without contact, [block_count] [m/s, rad/s]; out: expected
void expect_contacts(const Model& model,
                     const ModelState& start,
                     const std::vector<Point3>& change,
                     std::vector<Point3>& velocity);

}  // namespace tetwarp

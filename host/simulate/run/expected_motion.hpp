/// @file expected_motion.hpp
/// What the contacts of the step before let one expect of the next step.
#pragma once
#include <vector>

#include "host/simulate/model.hpp"

namespace tetwarp {

/// The velocities without contact of the step before: where solves of the next ones start.
/// @param start   state at the start of the step
/// @param change  by how much contacts changed the velocities in the step before, [block_count]
std::vector<Point3> free_velocities_before(const ModelState& start,
                                           const std::vector<Point3>& change);

/// Adds the changes to the velocities of bodies whose contacts hold: they would otherwise leave
/// the velocity of the step before, and with the changes they about keep it. What such a body would
/// hit if its contacts let go it does not hit.
/// @param velocity  in: without contact, [block_count]; out: as expected
void expect_contacts(const Model& model,
                     const ModelState& start,
                     const std::vector<Point3>& change,
                     std::vector<Point3>& velocity);

}  // namespace tetwarp

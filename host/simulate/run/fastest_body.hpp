/// @file fastest_body.hpp
/// The body that is named where a step fails.
#pragma once
#include <string>

#include "host/simulate/state/simulated_scene.hpp"
#include "host/simulate/step/stepper.hpp"

namespace tetwarp {

/// The body or obstacle with the largest velocity in a stepper, as "bodies[2] 'ball' (the
/// fastest, 3e5 m/s)": the first whose velocity is not finite, if there is one.
std::string fastest_body(const SimulatedScene& scene, const BodyStepper& stepper);

}  // namespace tetwarp

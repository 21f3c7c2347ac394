/// @file turning_moments.hpp
/// Which rigid bodies have a turn that a step must resolve.
#pragma once
#include <vector>

#include "host/simulate/state/simulated_scene.hpp"

namespace tetwarp {

/// Principal moments of inertia [kg m^2] of the rigid bodies whose turn moves what touches or what
/// a spring holds, [rigid of the model]; 0 of prescribed bodies, and of bodies with three equal
/// moments that touch as balls, or not at all, and that no spring holds: however fast they spin,
/// steps are as exact.
std::vector<Point3> turning_moments(const SimulatedScene& scene);

}  // namespace tetwarp

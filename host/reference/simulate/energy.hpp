/// @file energy.hpp
/// Energies of the reference, and the work done on it from outside.
#pragma once
#include <tetwarp/simulate.hpp>

#include "host/reference/simulate/assemble.hpp"
#include "host/reference/simulate/step_system.hpp"

namespace tetwarp::reference {

/// Work of the prescribed velocities, of the anchors and of the loads in a step.
double work_of(const System& system, const StepDrive& drive, const StepResult& result);
SceneEnergy energy_of(const System& system, const State& state, const Prescribed& prescribed);

}  // namespace tetwarp::reference

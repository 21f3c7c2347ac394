/// @file reference_stepper.hpp
/// The reference simulator as a BodyStepper.
#pragma once
#include <memory>

#include "host/scene/scene_geometry.hpp"
#include "host/simulate/step/scene_drive.hpp"
#include "host/simulate/step/stepper.hpp"

namespace tetwarp {

/// Steps of the reference, which derives masses, springs, scripts and loads from the scene itself
/// and reads only the times of a StepInput.
/// @param model  for the order of bodies and blocks; like the other arguments kept by the caller
/// @param drive  for what callers have moved
/// @throws std::invalid_argument  more blocks than its dense matrices have room for
std::unique_ptr<BodyStepper> make_reference_stepper(const Scene& scene,
                                                    const SceneGeometry& geometry,
                                                    const Model& model,
                                                    const SceneDrive& drive,
                                                    const StepperOptions& options);

}  // namespace tetwarp

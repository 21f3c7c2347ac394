/// @file fingerprint.hpp
/// The fingerprint of the scene that a checkpoint belongs to.
#pragma once
#include <cstdint>

#include "host/simulate/state/simulated_scene.hpp"

namespace tetwarp {

/// A hash of all that the results of a simulation depend on: the numbers of the model, of surfaces
/// and contact materials, of what drives them, and of how steps are solved. Equal for equal scenes
/// and options; threads, the device and work that is skipped are not part of it.
std::uint64_t fingerprint_of(const SimulatedScene& scene);

}  // namespace tetwarp

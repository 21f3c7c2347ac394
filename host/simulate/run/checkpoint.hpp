/// @file checkpoint.hpp
/// Checkpoints: the state of a simulation as bytes, with a version, a fingerprint of its scene and
/// a checksum.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "host/simulate/run/simulated_scene.hpp"
#include "host/simulate/run/simulation_state.hpp"

namespace tetwarp {

std::vector<std::byte> write_checkpoint(const SimulatedScene& scene, const SimulationState& state);

/// Reads and checks a checkpoint.
/// @param now  of the same scene, for the lengths of lists
/// @throws std::invalid_argument  in one line: it is damaged, belongs to another scene or was
///                                written by another version
SimulationState read_checkpoint(std::span<const std::byte> checkpoint,
                                const SimulatedScene& scene,
                                SimulationState now);

}  // namespace tetwarp

/// @file checkpoint.hpp
/// Checkpoints: the state of a simulation as bytes, with a version, a fingerprint of its scene and
/// a checksum.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "host/simulate/state/simulated_scene.hpp"
#include "host/simulate/state/simulation_state.hpp"

namespace tetwarp {

/// @param fingerprint  of the scene, without added handles
std::vector<std::byte> write_checkpoint(std::uint64_t fingerprint, const SimulationState& state);

/// Reads and checks a checkpoint, which may have other added handles than the scene.
/// @param fingerprint  of the scene, without added handles
/// @param now  of the same scene, for the lengths of lists
/// @throws std::invalid_argument  in one line: it is damaged, belongs to another scene or was
///                                written by another version
SimulationState read_checkpoint(std::span<const std::byte> checkpoint,
                                std::uint64_t fingerprint,
                                const SimulatedScene& scene,
                                SimulationState now);

}  // namespace tetwarp

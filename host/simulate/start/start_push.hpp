/// @file start_push.hpp
/// Bodies that start nearer than the thickness are moved apart before the first step.
#pragma once
#include <cstdint>
#include <vector>

#include "host/simulate/start/start_shrink.hpp"

namespace tetwarp {

/// Moves bodies so that no pair is nearer than the thickness, by the least sum of mass times
/// squared displacement: groups of coupled bodies as wholes, without turning; where that does not
/// suffice, as for bodies that are held or touch themselves, single nodes. Velocities stay. Pairs
/// that have no room for the thickness stay as near as they are.
/// @pre           no surfaces intersect
/// @param model   in, out: its start
/// @returns       [bodies] whether it has moved
std::vector<std::uint8_t> push_apart(const StartParts& parts, Model& model);

}  // namespace tetwarp

/// @file cage_growth.hpp
/// Start poses of elastic bodies by cages: bodies that were shrunk apart grow back as far as others
/// let them, each deformed smoothly by the outer vertices of a coarse lattice around it.
#pragma once
#include <vector>

#include "host/simulate/start/start_shrink.hpp"

namespace tetwarp {

/// Moves the cages of the bodies from their shrunk pose towards their full one, by steps that are
/// free of collisions: each goes towards the full pose as directly as the distances of near
/// features allow (least squares over the cages' vertices, where a shift of a whole body costs a
/// tenth of deforming it), and is halved until nothing passes through, distances are above the
/// thickness and no element falls below a tenth of its volume. Bodies that cannot make the shortest
/// step stay where they are. Ends where steps are below 1e-4 of a body's size, or after 300 steps.
/// @param bodies  elastic, as shrink_apart() left them
/// @param model   in, out: its start
/// @throws std::invalid_argument  in one line naming the body: too many weights
void grow_by_cages(const StartParts& parts, const std::vector<ShrunkBody>& bodies, Model& model);

}  // namespace tetwarp

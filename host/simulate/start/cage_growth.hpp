/// @file cage_growth.hpp
/// Start poses of elastic bodies by cages: bodies that were shrunk until they were apart grow back
/// as far as the other bodies leave room, each deformed smoothly by the outer vertices of a coarse
/// lattice around it.
#pragma once
#include <vector>

#include "host/simulate/start/start_shrink.hpp"

namespace tetwarp {

/// Moves the cages of the bodies from their shrunk pose towards their full one, in steps without
/// collisions. Each step is the motion nearest to the direct one that keeps the distances of near
/// features (least squares over the cages' vertices, where a shift of a whole body costs a tenth of
/// its deformation). It is halved until nothing passes through, all distances are above the
/// thickness, and no element has less than a tenth of its volume. Bodies that cannot make the
/// shortest step stay where they are. The growth ends where steps are below 1e-4 of a body's size,
/// or after 300 steps.
/// @param bodies  elastic, as shrink_apart() left them
/// @param model   in, out: its start
/// @throws std::invalid_argument  in one line naming the body: too many weights
void grow_by_cages(const StartParts& parts, const std::vector<ShrunkBody>& bodies, Model& model);

}  // namespace tetwarp

/// @file prepare_start.hpp
/// Prepares a start without collisions.
#pragma once
#include "host/simulate/start/rest_growth.hpp"
#include "host/simulate/start/start_shrink.hpp"

namespace tetwarp {

/// Separates bodies that intersect at the start: bodies with cage_start by their cages; with
/// `untangle` other elastic bodies and cloth are shrunk and grow back during the simulation. Then
/// checks that no bodies intersect, and pushes those apart that are nearer than the thickness.
/// Surfaces keep the areas that they had before.
/// @param model  in, out: its start, and the anchors of handles of caged bodies
/// @returns the growth of the shrunk bodies
/// @throws std::invalid_argument  as check_start() and shrink_apart(); or a body with cage_start
///         and driven nodes would have to move
RestGrowth prepare_start(const StartParts& parts, bool untangle, Model& model);

}  // namespace tetwarp

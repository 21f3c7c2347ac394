/// @file prepare_start.hpp
/// The start of a scene without collisions.
#pragma once
#include "host/simulate/start/rest_growth.hpp"
#include "host/simulate/start/start_shrink.hpp"

namespace tetwarp {

/// Brings bodies apart that are nearer than the thickness or overlap at the start: those with
/// cage_start by their cages; with `untangle` other elastic bodies and cloth are shrunk, to grow
/// back. Then checks that all are apart. Surfaces keep the areas of the start before.
/// @param model  in, out: its start, and the anchors of handles of caged bodies
/// @returns what makes shrunk bodies grow
/// @throws std::invalid_argument  as check_start() and shrink_apart(); a body with cage_start and
///         driven nodes would have to move
RestGrowth prepare_start(const StartParts& parts, bool untangle, Model& model);

}  // namespace tetwarp

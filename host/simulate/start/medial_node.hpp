/// @file medial_node.hpp
/// The node about which a body is scaled so that it stays within itself and comes out of others.
#pragma once
#include <cstdint>
#include <vector>

#include "host/simulate/start/start_shrink.hpp"

namespace tetwarp {

/// The node whose distance from the body's surface and from the surfaces of `others` is the
/// largest, among those within the body and outside of the others; if there is none the one
/// farthest from the surface. Cloth has no inside: what counts is the distance from its border,
/// taken as the sphere around the mean of its nodes.
/// @param places  of all surfaces, the body at full size
/// @param nodes   of the body, world
/// @param others  bodies and obstacles
Point3 medial_node(const StartParts& parts,
                   const SurfacePlaces& places,
                   const std::vector<Point3>& nodes,
                   std::int32_t body,
                   const std::vector<std::int32_t>& others);

}  // namespace tetwarp

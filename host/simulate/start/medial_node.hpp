/// @file medial_node.hpp
/// The node about which a body is scaled, so that the scaled body stays within the full one and
/// leaves other bodies.
#pragma once
#include <cstdint>
#include <vector>

#include "host/simulate/start/start_shrink.hpp"

namespace tetwarp {

/// The node with the largest distance from the body's own surface and from the surfaces of
/// `others`, among the nodes inside the body and outside the others; if there is none, the node
/// farthest from the body's own surface. Cloth has no inside: the distance from its own surface is
/// that from its border, which is taken as the sphere around the mean of its nodes.
/// @param places  of all surfaces, the body at full size
/// @param nodes   of the body, world
/// @param others  bodies and obstacles
Point3 medial_node(const StartParts& parts,
                   const SurfacePlaces& places,
                   const std::vector<Point3>& nodes,
                   std::int32_t body,
                   const std::vector<std::int32_t>& others);

}  // namespace tetwarp

/// @file edge_side.hpp
/// Whether an edge is what is nearest of the surface around it.
#pragma once
#include <cstdint>
#include <vector>

#include "host/simulate/contact/touch_area.hpp"

namespace tetwarp {

/// False where a triangle beside the edge comes nearer to what lies in a direction from the edge:
/// where the direction leans over the triangle by more than 3 degrees.
/// @param toward    unit, across the edge
/// @param vertices  at the time of the direction
bool is_nearest(const CollisionSurfaces& surfaces,
                const TouchAreas& areas,
                std::int32_t edge,
                const Point3& toward,
                const std::vector<Point3>& vertices);

}  // namespace tetwarp

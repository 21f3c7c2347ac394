/// @file surface.hpp
/// Triangle surfaces: boundary of tetrahedra, checks, volume.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/scene.hpp>

#include "host/scene/shapes/lattice.hpp"

namespace tetwarp {

/// The triangles that one tetrahedron alone has, counter-clockwise from outside, in order of
/// tetrahedra. @pre volumes are positive
std::vector<std::array<std::int32_t, 3>> boundary_triangles(
    const std::vector<std::array<std::int32_t, 4>>& tets);

/// The nodes that triangles use, ascending.
std::vector<std::int32_t> nodes_of(const std::vector<std::array<std::int32_t, 3>>& triangles);

/// The triangles as a surface whose points are nodes_of(triangles).
Surface surface_of(const std::vector<Point3>& nodes,
                   std::vector<std::array<std::int32_t, 3>> triangles);

/// Enclosed volume of a closed surface, negative if its triangles are clockwise from outside.
double volume_of(const Surface& surface);

/// @param place  of the surface, for messages
/// @throws std::invalid_argument  a triangle has no area
void check_areas(const std::string& place, const Surface& surface);

/// Checks that as many triangles pass every edge in one direction as in the other, and that the
/// enclosed volume is positive. Where parts touch in an edge it has four triangles.
/// @throws std::invalid_argument  naming an edge, or the volume
void check_closed(const std::string& place, const Surface& surface);

}  // namespace tetwarp

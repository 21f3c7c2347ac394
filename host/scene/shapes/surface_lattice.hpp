/// @file surface_lattice.hpp
/// Tetrahedra of a lattice that a closed surface touches or contains.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/scene.hpp>

#include "host/scene/shapes/lattice.hpp"

namespace tetwarp {

/// Whether a triangle may have a point in common with a tetrahedron: false only where a plane
/// separates them by more than rounding.
bool may_touch(const std::array<Point3, 4>& tet, const std::array<Point3, 3>& triangle);

/// How often a surface winds around a point: 1 inside a closed surface, 0 outside.
double winding_number(const Surface& surface, const Point3& point);

/// The tetrahedra of a frame that a triangle may touch and those inside.
/// @pre check_closed() has passed
/// @param is_cut  out, unless null: per tetrahedron whether a triangle may touch it
TetMesh tets_around(const LatticeFrame& frame,
                    const Surface& surface,
                    std::vector<std::uint8_t>* is_cut = nullptr);

/// Cubes around the surface's box, `cells` along its longest side; kept are the tetrahedra that a
/// triangle may touch and those inside.
/// @pre check_closed() has passed
/// @param place  of the surface, for messages
/// @throws std::invalid_argument  too many tetrahedra
TetMesh make_surface_lattice(const std::string& place, const Surface& surface, std::int64_t cells);

}  // namespace tetwarp

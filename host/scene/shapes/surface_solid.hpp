/// @file surface_solid.hpp
/// Lattices of what a closed surface encloses.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/scene.hpp>

#include "host/scene/shapes/shape_lattice.hpp"

namespace tetwarp {

/// Per tetrahedron the volume within a closed surface over its own volume, exact up to rounding.
/// @pre  tetrahedra that are not cut are inside
std::vector<double> fractions_within(const Surface& surface,
                                     const TetMesh& mesh,
                                     const std::vector<std::uint8_t>& is_cut);

/// Cells around a surface, without those outside, so that its points lie in tetrahedra. Parts of
/// tetrahedra below a hundredth of the mean one count as this, and all other ones, whole ones
/// included, as less by one factor from 0.99 to 1, so that the volumes add up to what the surface
/// encloses.
/// @pre check_closed() has passed
/// @param place  of the choice, for messages
/// @throws std::invalid_argument  too many tetrahedra
ShapeLattice make_solid_lattice(const std::string& place,
                                const Surface& surface,
                                const Lattice& choice);

}  // namespace tetwarp

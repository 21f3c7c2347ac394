/// @file check_geometry.hpp
/// Checks of the geometry of a body.
#pragma once
#include <string>

#include <tetwarp/scene.hpp>

namespace tetwarp {

/// The geometry of a body by itself, and its lattice and surface.
void check_geometry(const std::string& place, const Body& body);

void check_lattice(const std::string& place, const Lattice& lattice);

/// Points and triangles, without their topology. @param place  of the mesh
void check_surface(const std::string& place, const Surface& surface);

}  // namespace tetwarp

/// @file coarse_surface.hpp
/// Coarser surfaces, by the decimation of VTK in the program tetwarp-read.
#pragma once
#include <string>

#include <tetwarp/scene_parts.hpp>

namespace tetwarp {

/// A surface of fewer triangles, of the same topology and with some of the points, from which no
/// point of the given one is farther away than a distance, and no middle of a triangle from the
/// given one.
/// @param path      of the surface or what it is, which messages begin with
/// @param distance  above 0 [world]
/// @throws IoError  tetwarp-read is missing, was built without VTK, or fails
Surface coarse_surface(const std::string& path, const Surface& surface, double distance);

}  // namespace tetwarp

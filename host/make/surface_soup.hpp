/// @file surface_soup.hpp
/// All surfaces of a picture as one list of triangles with a normal per corner.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <tetwarp/make.hpp>

namespace tetwarp {

struct SurfaceSoup {
  std::vector<Point3> points;
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<std::array<Point3, 3>> normals;  ///< unit vectors of the corners of each triangle
  std::vector<std::int32_t> surface;           ///< of each triangle
  Point3 low{}, high{};                        ///< box of all points
};

/// The normal of a corner is the mean of those triangles around its point that are inclined to the
/// corner's triangle by less than 40 degrees, weighted by area.
/// @throws std::invalid_argument on an index out of range or a position that is not finite
SurfaceSoup make_soup(std::span<const DrawnSurface> surfaces);

}  // namespace tetwarp

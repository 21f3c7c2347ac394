/// @file shape_surface.hpp
/// Closed triangle surfaces of shapes.
#pragma once
#include <cstdint>

#include <tetwarp/scene.hpp>

#include "host/scene/shapes/surface_pattern.hpp"

namespace tetwarp {

/// Triangles of the surface of a shape where the scene does not say how many.
constexpr std::int64_t default_triangles = 1280;

/// Closed triangle surface of about `triangles` triangles, outwards; points are on the surface of
/// the shape. The count is the nearest that the pattern of the shape allows. With whole faces the
/// solid is that of divided ones, of fewer triangles: 12 of a box; cylinders, capsules and bent
/// strips are divided where they bend. Shapes that bend everywhere are equal either way.
Surface make_shape_surface(const Shape& shape,
                           std::int64_t triangles,
                           Faces faces = Faces::divided);

}  // namespace tetwarp

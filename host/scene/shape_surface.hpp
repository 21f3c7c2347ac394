/// @file shape_surface.hpp
/// Closed triangle surfaces of shapes.
#pragma once
#include <cstdint>

#include <tetwarp/scene.hpp>

namespace tetwarp {

/// Closed triangle surface of about `triangles` triangles, outwards; points are on the surface of
/// the shape. The count is the nearest that the pattern of the shape allows.
Surface make_shape_surface(const Shape& shape, std::int64_t triangles);

}  // namespace tetwarp

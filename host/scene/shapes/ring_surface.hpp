/// @file ring_surface.hpp
/// Surfaces of shapes that are made of rings of points.
#pragma once
#include <cstdint>

#include <tetwarp/scene.hpp>

#include "host/scene/shapes/surface_pattern.hpp"

namespace tetwarp {

/// See make_shape_surface().
Surface make_ring_surface(const CylinderShape& shape, std::int64_t triangles, Faces faces);
Surface make_ring_surface(const CapsuleShape& shape, std::int64_t triangles, Faces faces);
Surface make_ring_surface(const TorusShape& shape, std::int64_t triangles);
Surface make_ring_surface(const ArcShape& shape, std::int64_t triangles);

}  // namespace tetwarp

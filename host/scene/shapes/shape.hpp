/// @file shape.hpp
/// Shapes of valid sizes (see check_scene()): which points are inside, bounding box, volume.
#pragma once
#include <cstdint>
#include <functional>

#include <tetwarp/scene.hpp>

#include "host/base/point3.hpp"

namespace tetwarp {

/// The smallest box around the shape; of an arc the box of the whole torus' tube around its ends
/// and the directions of the axes in between.
Bounds bounds_of(const Shape& shape);

/// In closed form [m^3].
double volume_of(const Shape& shape);

/// A function of points that is negative inside the shape, 0 on its surface and positive outside,
/// and that changes by at most level_slope() times the distance of two points of the bounds.
std::function<double(const Point3&)> make_level(const Shape& shape);
double level_slope(const Shape& shape);

/// The length over which the level of the shape is no longer nearly linear [m]: the smallest radius
/// of curvature, or the thickness where there are edges.
double feature_length(const Shape& shape);

/// Height by which a bent strip raises its points at x.
double rise_of(const BentStripShape& strip, double x);

/// The box whose points rise_of() raises to the strip.
Bounds straight_bounds(const BentStripShape& strip);

}  // namespace tetwarp

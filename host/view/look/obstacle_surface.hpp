/// @file obstacle_surface.hpp
/// Obstacles as triangles, where they are at a time.
#pragma once
#include <optional>

#include <tetwarp/make.hpp>
#include <tetwarp/scene.hpp>

namespace tetwarp::view {

/// Displacement and rotation vector of a path at a time, linear between its points.
PathPoint path_at(const Path& path, double time);

/// The triangles of a sphere, a capsule or a mesh; nothing for a plane.
std::optional<Surface> surface_of(const Obstacle& obstacle, double time);

/// A plane; nothing for other obstacles.
std::optional<DrawnPlane> plane_of(const Obstacle& obstacle, double time);

}  // namespace tetwarp::view

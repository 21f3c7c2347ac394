/// @file motion.hpp
/// Where paths, hinges and waves are at a time.
#pragma once
#include <optional>

#include "host/reference/simulate/vectors.hpp"

namespace tetwarp::reference {

/// A displacement [m] and a turn about the origin of what moves.
struct PathPlace {
  Vector3d displacement = Vector3d::Zero();
  Vector3d axis_angle = Vector3d::Zero();
};

/// Whether `time` is `moment` or later but for rounding: times are multiples of a step.
bool is_reached(double moment, double time);

/// Linear between the points of a path, held before the first and after the last; nothing where the
/// last point at or before `time` has no displacement. An empty path does not move.
std::optional<PathPlace> path_at(const Path& path, double time);

/// The place of a body's frame that started at `start` after a move of its origin and a turn about
/// it.
Placement moved(const Placement& start, const PathPlace& place);

/// The frame of a scripted body at a time; a wave does not move it.
Placement frame_at(const Motion& motion, const Placement& start, double time);

/// Lateral displacement in the frame of the geometry of a point at s, 0 to 1, along the axis of a
/// body of extent `length`; zero without a wave.
Vector3d wave_at(const Motion& motion, double length, double s, double time);

}  // namespace tetwarp::reference

/// @file turning_frame.hpp
/// Where points of turning bodies are on the way of a SurfaceMotion.
#pragma once
#include <cmath>

#include "host/base/point3.hpp"
#include "host/collide/collision_surfaces.hpp"

namespace tetwarp {

inline Point3 point_of(const double* x) {
  return {x[0], x[1], x[2]};
}

/// The frame that a body turns with, or null: it goes straight.
inline const TurningFrame* frame_of(const SurfaceMotion& motion, std::int32_t body) {
  if (motion.frames.empty()) return nullptr;
  const TurningFrame& frame = at(motion.frames, body);
  return norm(point_of(frame.turn)) > 0 ? &frame : nullptr;
}

/// exp(time turn) of a direction.
inline Point3 turned(const TurningFrame& frame, double time, const Point3& direction) {
  const Point3 turn = point_of(frame.turn);
  const double angle = norm(turn), half = std::sin(time * angle / 2);
  const Point3 once = cross(times(1 / angle, turn), direction);
  const Point3 twice = cross(times(1 / angle, turn), once);
  return plus(direction, plus(times(std::sin(time * angle), once), times(2 * half * half, twice)));
}

/// How far a point of a body has gone at a time.
inline Point3 way_at(const TurningFrame* frame,
                     const Point3& start,
                     const Point3& end,
                     double time) {
  if (frame == nullptr) return times(time, minus(end, start));
  const Point3 arm = minus(start, point_of(frame->centre));
  return plus(times(time, point_of(frame->motion)), minus(turned(*frame, time, arm), arm));
}

}  // namespace tetwarp

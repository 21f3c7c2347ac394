/// @file surface_move.hpp
/// Places of surface points, frames and planes at the start of a step, and where velocities move
/// them: nodes straight, frames by exp(dt omega).
///
/// Products are rounded before they are added: places at the start have the same bits on host and
/// device, and a point that does not move has the same bits at start and end.
#pragma once
#include <cmath>
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/body/lane_math.hpp"
#include "kernels/body/rigid_midpoint.hpp"

namespace tetwarp {

/// A vertex of a surface with what it moves with, as ModelPoint: up to four nodes, a frame, or
/// nothing if it is fixed in the world. The functions below take this type or a ModelPoint.
struct SurfacePoint {
  std::int32_t node[4];
  std::int32_t rigid;
  std::int32_t body;
  double weight[4];
  double local[3];
};

/// Nodes and frames at the start of a step.
struct SurfaceState {
  View<const double> position;  ///< [nodes][3] [m]
  View<const double> center;    ///< [rigid][3] [m]
  View<const double> rotation;  ///< [rigid][4] quaternion, frame to world
};

/// Velocities and durations of the motion.
struct SurfaceVelocity {
  View<const double> velocity;  ///< [blocks][3] [m/s, rad/s]
  std::int64_t first_block;     ///< of frames
  double time_step;             ///< [s]
  View<const double> fraction;  ///< [bodies] of the step that each body moves, or empty: 1

  TETWARP_HD double seconds_of(std::int64_t body) const {
    return fraction.size == 0 ? time_step : time_step * fraction[body];
  }
};

/// A frame after a part of a step.
struct MovedFrame {
  double start[3], end[3];  ///< center [m]
  double rotation[4];       ///< at the end
  double axis[3];           ///< unit, of the turn; 0 if there is none
  double angle;             ///< of the turn [rad]
};

/// Length of a vector; scaled, so that squares do not overflow or underflow.
TETWARP_HD double length3(const double* x) {
  const double a = fabs(x[0]), b = fabs(x[1]), c = fabs(x[2]), most = max_of(max_of(a, b), c);
  if (most == 0) return 0;
  const double u = a / most, v = b / most, w = c / most;
  return most * sqrt(mul_rn(u, u) + mul_rn(v, v) + mul_rn(w, w));
}
/// The unit vector along x; zero for a zero vector. x and unit may be the same memory.
TETWARP_HD void unit3(const double* x, double* unit) {
  const double size = length3(x), factor = size > 0 ? 1 / size : 1;
  const bool is_tiny = !(factor < INFINITY);
  for (int i = 0; i < 3; ++i) unit[i] = is_tiny ? x[i] / size : factor * x[i];
}
/// x turned by a unit quaternion.
TETWARP_HD void rotate3(const double* q, const double* x, double* turned) {
  const double* const axis = q + 1;
  const auto cross_of = [](const double* a, const double* b, int i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    return mul_rn(a[j], b[k]) - mul_rn(a[k], b[j]);
  };
  double t[3];
  for (int i = 0; i < 3; ++i) t[i] = 2 * cross_of(axis, x, i);
  for (int i = 0; i < 3; ++i) turned[i] = x[i] + (mul_rn(q[0], t[i]) + cross_of(axis, t, i));
}

/// World position of a point that is fixed in a frame.
TETWARP_HD void frame_point(const double* center,
                            const double* rotation,
                            const double* local,
                            double* x) {
  double arm[3];
  rotate3(rotation, local, arm);
  for (int i = 0; i < 3; ++i) x[i] = center[i] + arm[i];
}
/// World position of a point that moves with nodes.
/// @param place  (node, i): coordinate i of a node
template <class Point, class Place>
TETWARP_HD void node_point(const Point& point, const Place& place, double* x) {
  for (int i = 0; i < 3; ++i) x[i] = point.node[0] < 0 ? point.local[i] : 0;
  for (int k = 0; k < 4 && point.node[k] >= 0; ++k) {
    for (int i = 0; i < 3; ++i) x[i] += mul_rn(point.weight[k], place(point.node[k], i));
  }
}
/// World point and normal of a plane that is fixed in a frame, [6] each.
TETWARP_HD void frame_plane(const double* center,
                            const double* rotation,
                            const double* local,
                            double* plane) {
  frame_point(center, rotation, local, plane);
  rotate3(rotation, local + 3, plane + 3);
  unit3(plane + 3, plane + 3);
}

template <class Point>
TETWARP_HD void start_of(const Point& point, const SurfaceState& at, double* x) {
  if (point.rigid >= 0) {
    const std::int64_t r = point.rigid;
    return frame_point(at.center.data + 3 * r, at.rotation.data + 4 * r, &point.local[0], x);
  }
  node_point(
      point, [&](std::int64_t node, int i) { return at.position[3 * node + i]; }, x);
}

TETWARP_HD MovedFrame moved_frame(const SurfaceState& at,
                                  const SurfaceVelocity& by,
                                  std::int64_t rigid,
                                  double seconds) {
  const double* const v = by.velocity.data + 3 * (by.first_block + 2 * rigid);
  MovedFrame frame;
  double turn[3];
  for (int i = 0; i < 3; ++i) {
    frame.start[i] = at.center[3 * rigid + i];
    frame.end[i] = frame.start[i] + mul_rn(seconds, v[i]);
    turn[i] = seconds * v[3 + i];
  }
  for (int i = 0; i < 4; ++i) frame.rotation[i] = at.rotation[4 * rigid + i];
  frame.angle = length3(turn);
  unit3(turn, frame.axis);
  if (frame.angle > 0) turn_by_vector(turn, frame.rotation);
  return frame;
}

/// Writes a TurningFrame: center, motion and rotation vector, [9]; all 0 where the frame does not
/// turn.
TETWARP_HD void turn_of(const MovedFrame& frame, double* turning) {
  const bool turns = frame.angle > 0;
  for (int i = 0; i < 3; ++i) {
    turning[i] = turns ? frame.start[i] : 0;
    turning[3 + i] = turns ? frame.end[i] - frame.start[i] : 0;
    turning[6 + i] = turns ? frame.angle * frame.axis[i] : 0;
  }
}

/// @param frame  that the point is fixed in; not read for other points
/// @param start  of the point
/// @param end    out
/// @returns the largest distance of the point from its straight path [m]: linear interpolation errs
///          by at most 1/8 of the second derivative, r angle^2 on a circle of radius r
template <class Point>
TETWARP_HD double move_point(const Point& point,
                             const SurfaceState& at,
                             const SurfaceVelocity& by,
                             double seconds,
                             const MovedFrame& frame,
                             const double* start,
                             double* end) {
  if (point.rigid < 0) {
    const auto moved = [&](std::int64_t node, int i) {
      return at.position[3 * node + i] + mul_rn(seconds, by.velocity[3 * node + i]);
    };
    node_point(point, moved, end);
    return 0;
  }
  frame_point(frame.end, frame.rotation, &point.local[0], end);
  if (!(frame.angle > 0)) return 0;
  double arm[3], across[3];
  for (int i = 0; i < 3; ++i) arm[i] = start[i] - frame.start[i];
  cross3(frame.axis, arm, across);
  return length3(across) * frame.angle * frame.angle / 8;
}

/// One index = one vertex, then one plane. Writes its own place at the start; any order.
struct SurfaceStartOp {
  View<const SurfacePoint> points;
  View<const double> plane_local;        ///< [planes][6] point and normal in a frame
  View<const std::int32_t> plane_rigid;  ///< [planes] that frame
  SurfaceState at;
  View<double> start;        ///< out [vertices][3]
  View<double> plane_start;  ///< out [planes][6]

  TETWARP_HD void operator()(std::int64_t i) const {
    if (i < points.size) return start_of(points[i], at, start.data + 3 * i);
    const std::int64_t p = i - points.size, r = plane_rigid[p];
    frame_plane(at.center.data + 3 * r, at.rotation.data + 4 * r, plane_local.data + 6 * p,
                plane_start.data + 6 * p);
  }
};

/// One index = one body. Writes its own frame; any order.
struct FrameMoveOp {
  View<const std::int32_t> body_rigid;  ///< [bodies] frame, or -1
  SurfaceState at;
  SurfaceVelocity by;
  View<MovedFrame> moved;  ///< out [bodies] of those with a frame
  View<double> turning;    ///< out [bodies][9] see turn_of()

  TETWARP_HD void operator()(std::int64_t b) const {
    MovedFrame frame{};
    if (body_rigid[b] >= 0) frame = moved_frame(at, by, body_rigid[b], by.seconds_of(b));
    turn_of(frame, turning.data + 9 * b);
    moved[b] = frame;
  }
};

/// One index = one vertex, then one plane. Writes its own place at the end; any order.
struct SurfaceMoveOp {
  View<const SurfacePoint> points;
  View<const double> plane_local;       ///< [planes][6]
  View<const std::int32_t> plane_body;  ///< [planes]
  SurfaceState at;
  SurfaceVelocity by;
  View<const MovedFrame> moved;  ///< [bodies]
  View<const double> start;      ///< [vertices][3]
  View<double> end;              ///< out [vertices][3]
  View<double> sagitta;          ///< out [vertices]
  View<double> plane_end;        ///< out [planes][6]

  TETWARP_HD void operator()(std::int64_t i) const {
    if (i < points.size) {
      const SurfacePoint& point = points[i];
      sagitta[i] = move_point(point, at, by, by.seconds_of(point.body), moved[point.body],
                              start.data + 3 * i, end.data + 3 * i);
      return;
    }
    const std::int64_t p = i - points.size;
    const MovedFrame& frame = moved[plane_body[p]];
    frame_plane(frame.end, frame.rotation, plane_local.data + 6 * p, plane_end.data + 6 * p);
  }
};

}  // namespace tetwarp

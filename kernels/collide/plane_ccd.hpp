/// @file plane_ccd.hpp
/// When a vertex comes within a distance of a plane that moves and turns.
#pragma once
#include <cmath>

#include "kernels/base/hd.hpp"
#include "kernels/collide/moving_points.hpp"
#include "kernels/collide/pair_ccd.hpp"

namespace tetwarp {

/// A plane at the start and at the end. Between them, point and normal follow the frame. Without a
/// frame the point moves straight, and the normal turns at constant speed by the smallest angle,
/// which is below half a turn.
struct MovingPlane {
  const double *point_start, *normal_start, *point_end, *normal_end;
  const TurningFrame* frame = nullptr;
};

/// Rotation vector that takes unit vector a to b by the smallest angle.
/// @returns false where b is nearly -a
TETWARP_HD bool least_turn(const double* a, const double* b, double* turn) {
  cross3(a, b, turn);
  const double sine = std::sqrt(dot3(turn, turn)), cosine = dot3(a, b);
  if (cosine < 0 && sine < 1e-6) return false;
  const double scale = sine > 0 ? std::atan2(sine, cosine) / sine : 0;
  for (int i = 0; i < 3; ++i) turn[i] *= scale;
  return true;
}

/// Point 0 against the half-space of a plane; the distance is negative inside the half-space.
///
/// With x the vertex from the plane's point and n the normal, f = x . n changes by
/// x' . n + x . n', at most |x'| + angle |x|: |x'| is bounded as that of any two points, and n'
/// is at right angles to n with length at most `angle`. |x| is at most the larger of its values at
/// the two ends, where it is largest on straight paths, plus the deviation from straight paths.
TETWARP_HD CcdResult vertex_plane_ccd(const MovingPoints& points,
                                      const MovingPlane& plane,
                                      const CcdLimits& limits) {
  MovingPoints both = points;
  both.start[1] = plane.point_start, both.end[1] = plane.point_end;
  both.sagitta_b = 0, both.frame_b = plane.frame;
  const LocalPoints<2> local(both, 1);
  double turn[3] = {0, 0, 0};
  if (plane.frame) {
    for (int i = 0; i < 3; ++i) turn[i] = plane.frame->turn[i];
  } else if (!least_turn(plane.normal_start, plane.normal_end, turn)) {
    return {0, 0, 0};
  }
  const double angle = std::sqrt(dot3(turn, turn));
  double axis[3] = {0, 0, 0}, sine_part[3], cosine_part[3], reach = 0;
  for (int i = 0; angle > 0 && i < 3; ++i) axis[i] = turn[i] / angle;
  cross3(axis, plane.normal_start, sine_part);
  cross3(axis, sine_part, cosine_part);
  for (int end = 0; end < 2; ++end) {
    double square = 0;
    for (int i = 0; i < 3; ++i) {
      const double way = local.motion[0][i] - local.motion[1][i];
      square += square_of(local.start[0][i] - local.start[1][i] + end * way);
    }
    reach = max_of(reach, std::sqrt(square));
  }
  reach += local.sagitta + local.speed / 4;  // a bow is at most a quarter of its largest speed
  const double speed = local.speed + angle * reach;
  const double acceleration = local.acceleration + angle * (2 * local.speed + angle * reach);
  return advance(speed, acceleration, local.sagitta, limits, [&](double time, Approach& approach) {
    double x[2][3], v[2][3], d[3], change[3], height = 0, rate = 0;
    local.at(time, x, v);
    minus3(x[0], x[1], d), minus3(v[0], v[1], change);
    const double half = std::sin(time * angle / 2), sine = std::sin(time * angle);
    for (int i = 0; i < 3; ++i) {
      const double up = 2 * half * half * cosine_part[i];
      const double n = plane.normal_start[i] + sine * sine_part[i] + up;
      const double turning = angle * ((1 - 2 * half * half) * sine_part[i] + sine * cosine_part[i]);
      height += d[i] * n;
      rate += change[i] * n + d[i] * turning;
    }
    approach.gap[0] = height - points.radius;
    approach.rate[0] = rate;
    approach.count = 1;
    return approach.gap[0];
  });
}

}  // namespace tetwarp

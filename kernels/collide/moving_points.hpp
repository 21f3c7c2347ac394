/// @file moving_points.hpp
/// The points of two features during a motion, in coordinates of the pair.
#pragma once
#include <cmath>
#include <cstdint>

#include "kernels/base/hd.hpp"
#include "kernels/collide/pair_distance.hpp"

namespace tetwarp {

/// A frame that turns at constant speed while its center goes straight:
/// x(time) = center + time motion + exp(time turn) (x(0) - center).
struct TurningFrame {
  double center[3];
  double motion[3];
  double turn[3];  ///< rotation vector [rad]
};

/// Up to four points that move from start to end.
///
/// Without frames the points move on nearly straight paths: at time t, from 0 to 1, a point is
/// within 4 t (1 - t) sagitta of start + t (end - start). This holds for every motion whose
/// acceleration is at most 8 sagitta per squared duration of the motion: its difference from the
/// straight path is 0 at both ends, and 4 t (1 - t) sagitta has the largest second derivative
/// allowed at every t. A point at distance r from the axis of a frame that turns by an angle has
/// sagitta r angle^2 / 8.
///
/// With frames the points of that side follow the frame exactly, and its sagitta is not used.
struct MovingPoints {
  const double* start[4];  ///< [3] each
  const double* end[4];
  double sagitta_a, sagitta_b;  ///< largest of the points of each side [m]
  double radius;                ///< sum of both sides [m]
  const TurningFrame* frame_a = nullptr;
  const TurningFrame* frame_b = nullptr;
};

/// Difference of turning points of one side from their straight paths, at one time:
/// bow = sine (axis x arm) + cosine (axis x (axis x arm)), 0 at times 0 and 1.
struct Bow {
  double angle = 0;

  TETWARP_HD void factors(double time, double* sine, double* cosine) const {
    const double half = std::sin(time * angle / 2), whole = std::sin(angle / 2);
    *sine = std::sin(time * angle) - time * std::sin(angle);
    *cosine = 2 * half * half - time * 2 * whole * whole;
  }
  /// Derivatives of the factors.
  TETWARP_HD void rates(double time, double* sine, double* cosine) const {
    const double whole = std::sin(angle / 2);
    *sine = angle * std::cos(time * angle) - std::sin(angle);
    *cosine = angle * std::sin(time * angle) - 2 * whole * whole;
  }
};

/// Points in coordinates of the pair: the first point is the origin, and the mean motion is
/// subtracted. So pairs far from the origin of the world lose no digits beyond those of the input.
template <int count>
struct LocalPoints {
  double start[count][3], motion[count][3];
  double bow_sine[count][3], bow_cosine[count][3];
  Bow bow[2];           ///< of each side
  int a_count;          ///< points of side a
  double speed;         ///< bound on the rate of all distances between the sides, without sagittas
  double acceleration;  ///< of points that follow frames: largest of side a plus largest of side b
  double sagitta;       ///< sum over the sides that follow no frame

  TETWARP_HD LocalPoints(const MovingPoints& points, int a_count) : a_count(a_count) {
    for (int i = 0; i < 3; ++i) {
      double mean = 0;
      for (int k = 0; k < count; ++k) {
        start[k][i] = points.start[k][i] - points.start[0][i];
        motion[k][i] = points.end[k][i] - points.start[k][i];
        mean += motion[k][i] / count;
      }
      for (int k = 0; k < count; ++k) motion[k][i] -= mean;
    }
    sagitta = (points.frame_a ? 0 : points.sagitta_a) + (points.frame_b ? 0 : points.sagitta_b);
    speed = acceleration = 0;
    for (int side = 0; side < 2; ++side) {
      const TurningFrame* const frame = side ? points.frame_b : points.frame_a;
      const int begin = side ? a_count : 0, end = side ? count : a_count;
      double most = 0, own = 0;
      for (int k = begin; k < end; ++k) most = max_of(most, dot3(motion[k], motion[k]));
      if (frame) own = turn_points(points, *frame, side, begin, end);
      speed += std::sqrt(most) + own / 2;  // |f'| <= M / 2 if f(0) = f(1) = 0 and |f''| <= M
      acceleration += own;
    }
  }

  TETWARP_HD void at(double time, double (*place)[3], double (*velocity)[3]) const {
    for (int k = 0; k < count; ++k) {
      for (int i = 0; i < 3; ++i) {
        place[k][i] = start[k][i] + time * motion[k][i];
        velocity[k][i] = motion[k][i];
      }
    }
    for (int side = 0; side < 2; ++side) {
      if (!(bow[side].angle > 0)) continue;
      double sine, cosine, sine_rate, cosine_rate;
      bow[side].factors(time, &sine, &cosine);
      bow[side].rates(time, &sine_rate, &cosine_rate);
      for (int k = side ? a_count : 0; k < (side ? count : a_count); ++k) {
        for (int i = 0; i < 3; ++i) {
          place[k][i] += sine * bow_sine[k][i] + cosine * bow_cosine[k][i];
          velocity[k][i] += sine_rate * bow_sine[k][i] + cosine_rate * bow_cosine[k][i];
        }
      }
    }
  }

 private:
  /// @returns the largest acceleration of the points
  TETWARP_HD double turn_points(
      const MovingPoints& points, const TurningFrame& frame, int side, int begin, int end) {
    const double angle = std::sqrt(dot3(frame.turn, frame.turn));
    bow[side].angle = angle;
    if (!(angle > 0)) return 0;
    double axis[3], arm[3], most = 0;
    for (int i = 0; i < 3; ++i) axis[i] = frame.turn[i] / angle;
    for (int k = begin; k < end; ++k) {
      minus3(points.start[k], frame.center, arm);
      cross3(axis, arm, bow_sine[k]);
      cross3(axis, bow_sine[k], bow_cosine[k]);
      most = max_of(most, dot3(bow_sine[k], bow_sine[k]));
    }
    return angle * angle * std::sqrt(most);
  }
};

}  // namespace tetwarp

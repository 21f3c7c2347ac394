/// @file pair_ccd.hpp
/// When the surfaces of two features come within a distance of each other during a motion: additive
/// continuous collision detection. Source: Li, Kaufman and Jiang 2021; the absolute slack, the rule
/// for near starts and the bounds of turning points are ours.
#pragma once
#include <cmath>
#include <cstdint>

#include "kernels/base/hd.hpp"
#include "kernels/collide/moving_points.hpp"
#include "kernels/collide/pair_distance.hpp"

namespace tetwarp {

/// How near counts as touching. Up to and including its time of touch a pair is never within
/// `distance`. A pair that would come within `distance` always touches; one that only comes within
/// `distance` + `slack` may touch.
///
/// A pair that starts nearer than that keeps at least half of its distance. With d the distance at
/// the start:
///
///     least = distance where d > distance, else max(d / 2, distance / 100)
///     touch at the first time found with a distance below least + min(slack, (d - least) / 2),
///     at time 0 if d <= distance / 100
///
/// So a pair that rests or separates does not touch, wherever it starts. Where no pair moves beyond
/// its time of touch, pairs farther apart than `distance` stay so. Nearer pairs, which only
/// rounding or the start of a scene produces, stay farther apart than `distance` / 100.
struct CcdLimits {
  double distance = 0;                  ///< [m], > 0
  double slack = 0;                     ///< absolute [m], > 0
  std::int32_t max_evaluations = 4096;  ///< then the pair touches at the time reached
};
/// Limits of the detection that finds the contacts of a step.
/// @param thickness  rest distance of surfaces [m]
TETWARP_HD CcdLimits detection_limits(double thickness) {
  return {thickness / 2, thickness / 10};
}
/// Limits of the check that ends a step early. Pairs at rest are at the thickness, 18 times the
/// slack above this distance.
TETWARP_HD CcdLimits end_check_limits(double thickness) {
  return {thickness / 10, thickness / 20};
}

struct CcdResult {
  double time = 2;            ///< 0 to 1, or 2: the pair does not touch
  double start_distance = 0;  ///< [m], radii subtracted
  std::int32_t evaluations = 0;
};

/// Gaps between points of both sides along one fixed direction, and their rates. The distance of
/// the sides is at least the smallest gap, at every later time.
struct Approach {
  double gap[4];   ///< between a point of a and one of b along the direction, radii subtracted [m]
  double rate[4];  ///< of change of each gap per unit of time
  int count = 0;   ///< 0: no bound is known

  /// @param apart  from the closest point of b to that of a
  template <int points>
  TETWARP_HD void set(const LocalPoints<points>& local,
                      const double (*place)[3],
                      const double (*velocity)[3],
                      const double* apart,
                      double radius) {
    const double length = std::sqrt(dot3(apart, apart));
    count = 0;
    if (!(length > 0)) return;
    for (int a = 0; a < local.a_count; ++a) {
      for (int b = local.a_count; b < points; ++b, ++count) {
        double way[3], change[3];
        minus3(place[a], place[b], way), minus3(velocity[a], velocity[b], change);
        gap[count] = dot3(way, apart) / length - radius;
        rate[count] = dot3(change, apart) / length;
      }
    }
  }

  /// The longest time for which all gaps exceed `least`, if rates fall by at most `acceleration`
  /// per unit of time and gaps lose `loss` per unit of time besides.
  TETWARP_HD double time_above(double least, double acceleration, double loss) const {
    double time = count > 0 ? 4 : 0;
    for (int k = 0; k < count; ++k) {
      const double room = gap[k] - least, slope = rate[k] - loss;
      if (!(room > 0)) return 0;
      const double root = std::sqrt(slope * slope + 2 * acceleration * room);
      // Solves room + slope t - acceleration t^2 / 2 = 0; 4 stands for no root (slope >= 0,
      // acceleration = 0).
      const double own = slope < 0          ? 2 * room / (root - slope)
                         : acceleration > 0 ? (slope + root) / acceleration
                                            : 4;
      time = min_of(time, own);
    }
    return time;
  }
};

/// Additive advancement.
///
/// The room at time t is distance - least - 4 t (1 - t) sagitta. It stays above a tenth of its
/// value at t for the longer of two times:
/// - 0.9 room / b(t): from t on the room falls by at most b(t) = speed + 4 sagitta max(0, 1 - 2 t)
///   per unit of time, and b never grows.
/// - Approach::time_above(): along any direction convex features are at most as far apart as they
///   are; the direction is that of the closest points at t. Points that move straight approach
///   along it at constant rates, others at rates that change by at most `acceleration`.
/// So the room is positive up to the time reached, and to the end where that time is above 1.
/// Rounding: the error of a distance is below 1e-14 of the pair's extent, a thousandth of
/// `distance`; for needles it is below a thousandth of the distance itself.
/// @param measure  (time, Approach&) gives the distance, which changes by at most `speed` per unit
///                 of time
template <class Measure>
TETWARP_HD CcdResult advance(
    double speed, double acceleration, double sagitta, const CcdLimits& limits, Measure measure) {
  CcdResult result;
  Approach approach;
  double time = 0, least = 0, slack = 0;
  while (true) {  // the only call of measure(), so that the compiler inlines it
    const double distance = measure(time, approach);
    if (result.evaluations++ == 0) {
      result.start_distance = distance;
      least = distance > limits.distance ? limits.distance
                                         : max_of(distance / 2, limits.distance / 100);
      if (!(distance > least)) break;
      slack = min_of(limits.slack, (distance - least) / 2);
    }
    const double taken = least + 4 * sagitta * time * (1 - time), room = distance - taken;
    const double loss = 4 * sagitta * max_of(0.0, 1 - 2 * time), bound = speed + loss;
    if (room > (1 - time) * bound) return result;
    if (!(room >= slack)) break;
    if (result.evaluations >= limits.max_evaluations) break;
    const double along = approach.time_above(taken + 0.1 * room, acceleration, loss);
    const double next = time + max_of(0.9 * room / bound, along);
    if (next > 1) return result;
    if (!(next > time)) break;
    time = next;
  }
  result.time = time;
  return result;
}

/// advance() for features that are the convex hulls of their points.
/// @param closest  (places, apart) gives the distance without radii, and the way from the closest
///                 point of b to that of a
template <int count, class Closest>
TETWARP_HD CcdResult
ccd_of_points(const MovingPoints& points, int a_count, const CcdLimits& limits, Closest closest) {
  const LocalPoints<count> local(points, a_count);
  return advance(local.speed, local.acceleration, local.sagitta, limits,
                 [&](double time, Approach& approach) {
                   double x[count][3], v[count][3], apart[3];
                   local.at(time, x, v);
                   const double distance = closest(x, apart);
                   approach.set(local, x, v, apart, points.radius);
                   return distance - points.radius;
                 });
}

/// Points 0; 1, 2, 3: vertex against face.
TETWARP_HD CcdResult vertex_face_ccd(const MovingPoints& points, const CcdLimits& limits) {
  return ccd_of_points<4>(points, 1, limits, [](const double(*x)[3], double* apart) {
    double w[3];
    const double distance = vertex_face_distance(x[0], x[1], x[2], x[3], w);
    for (int i = 0; i < 3; ++i) {
      apart[i] = x[0][i] - (w[0] * x[1][i] + w[1] * x[2][i] + w[2] * x[3][i]);
    }
    return distance;
  });
}
/// Points 0, 1; 2, 3: edge against edge.
TETWARP_HD CcdResult edge_edge_ccd(const MovingPoints& points, const CcdLimits& limits) {
  return ccd_of_points<4>(points, 2, limits, [](const double(*x)[3], double* apart) {
    double s, t;
    const double distance = edge_edge_distance(x[0], x[1], x[2], x[3], &s, &t);
    for (int i = 0; i < 3; ++i) {
      apart[i] = (1 - s) * x[0][i] + s * x[1][i] - ((1 - t) * x[2][i] + t * x[3][i]);
    }
    return distance;
  });
}
/// Points 0; 1, 2: vertex against edge.
TETWARP_HD CcdResult vertex_edge_ccd(const MovingPoints& points, const CcdLimits& limits) {
  return ccd_of_points<3>(points, 1, limits, [](const double(*x)[3], double* apart) {
    double s;
    const double square = vertex_edge_square(x[0], x[1], x[2], &s);
    for (int i = 0; i < 3; ++i) apart[i] = x[0][i] - ((1 - s) * x[1][i] + s * x[2][i]);
    return std::sqrt(square);
  });
}
/// Points 0; 1.
TETWARP_HD CcdResult vertex_vertex_ccd(const MovingPoints& points, const CcdLimits& limits) {
  return ccd_of_points<2>(points, 1, limits, [](const double(*x)[3], double* apart) {
    minus3(x[0], x[1], apart);
    return std::sqrt(dot3(apart, apart));
  });
}

}  // namespace tetwarp

/// @file pair_apart.hpp
/// Directions along which two items, or two features, stay apart during a whole motion: a
/// sufficient test that costs less than the time of contact.
///
/// Points move straight, so the separation of two points along a fixed direction changes linearly:
/// if it exceeds a distance at the start and at the end, it does so all the time. Along a
/// direction, convex hulls are as far apart as their nearest corners.
#pragma once
#include <cstdint>

#include "kernels/collide/collide_item.hpp"
#include "kernels/collide/pair_distance.hpp"

namespace tetwarp {

/// Bounds of points along the axes of coordinates, at start and end.
struct MovingBounds {
  double low[2][3], high[2][3];

  TETWARP_HD void set(int t, const double* place) {
    for (int i = 0; i < 3; ++i) low[t][i] = high[t][i] = place[i];
  }
  TETWARP_HD void add(int t, const double* place) {
    for (int i = 0; i < 3; ++i) {
      low[t][i] = min_of(low[t][i], place[i]);
      high[t][i] = max_of(high[t][i], place[i]);
    }
  }
};

/// Whether two sets of points stay apart along an axis of coordinates.
TETWARP_HD bool bounds_apart(const MovingBounds& a, const MovingBounds& b, double distance) {
  bool apart = false;
  for (int i = 0; i < 3; ++i) {
    const double above = min_of(b.low[0][i] - a.high[0][i], b.low[1][i] - a.high[1][i]);
    const double below = min_of(a.low[0][i] - b.high[0][i], a.low[1][i] - b.high[1][i]);
    apart |= max_of(above, below) > distance;
  }
  return apart;
}

/// Corners of an item relative to a point near it.
struct ItemPoints {
  double place[2][3][3];  ///< [start, end][corner]
  std::int32_t count;
  double extra;         ///< largest radius plus sagitta of the corners
  MovingBounds bounds;  ///< set by find_bounds()

  TETWARP_HD ItemPoints(const CollideItem& item,
                        const MotionView& motion,
                        View<const double> radius,
                        const double* origin)
      : count(item.count), extra(0) {
    for (int k = 0; k < 3; ++k) {
      const std::int64_t v = item.vertex[k < count ? k : 0];
      extra = max_of(extra, radius[v] + motion.sagitta[v]);
      for (int i = 0; i < 3; ++i) {
        place[0][k][i] = motion.start[3 * v + i] - origin[i];
        place[1][k][i] = motion.end[3 * v + i] - origin[i];
      }
    }
  }
  TETWARP_HD void find_bounds() {
    for (int t = 0; t < 2; ++t) {
      bounds.set(t, place[t][0]);
      for (int k = 1; k < 3; ++k) bounds.add(t, place[t][k]);
    }
  }
  TETWARP_HD MovingBounds corner_bounds(int k) const {
    MovingBounds own;
    for (int t = 0; t < 2; ++t) own.set(t, place[t][k]);
    return own;
  }
  /// Bounds of the edge from corner k to the next.
  TETWARP_HD MovingBounds edge_bounds(int k) const {
    MovingBounds own;
    for (int t = 0; t < 2; ++t) {
      own.set(t, place[t][k]);
      own.add(t, place[t][(k + 1) % count]);
    }
    return own;
  }
  /// The largest coordinate in magnitude.
  TETWARP_HD double size() const {
    double size = 0;
    for (int t = 0; t < 2; ++t) {
      for (int k = 0; k < 3; ++k) {
        for (int i = 0; i < 3; ++i) size = max_of(size, fabs(place[t][k][i]));
      }
    }
    return size;
  }
};

/// Separation of the corners of two items beyond which the items are certainly farther apart than
/// `distance`: radii, sagittas and rounding are added.
/// @param distance  search distance [m]
TETWARP_HD double distance_apart(const ItemPoints& a, const ItemPoints& b, double distance) {
  const double roundings = 0x1p-46 * max_of(a.size(), b.size());
  return (distance + a.extra + b.extra) * (1 + 0x1p-40) + roundings;
}

/// Whether a separation along an axis exceeds `distance`.
/// @param separation  times the length of the axis
TETWARP_HD bool is_apart(double separation, double axis_squared, double distance) {
  return separation > 0 && separation * separation > distance * distance * axis_squared;
}

/// The side of a face at which each corner of another item stays, farther than `distance` from the
/// face's plane at the start.
struct FaceSides {
  std::int32_t side[3];  ///< 1 or -1; 0: neither is certain

  TETWARP_HD FaceSides(const ItemPoints& face, const ItemPoints& other, double distance) {
    double ab[3], ac[3], normal[3];
    for (int i = 0; i < 3; ++i) {
      ab[i] = face.place[0][1][i] - face.place[0][0][i];
      ac[i] = face.place[0][2][i] - face.place[0][0][i];
    }
    cross3(ab, ac, normal);
    const double squared = dot3(normal, normal);
    double low[2], high[2];
    for (int t = 0; t < 2; ++t) {
      low[t] = high[t] = dot3(normal, face.place[t][0]);
      for (int k = 1; k < 3; ++k) {
        const double height = dot3(normal, face.place[t][k]);
        low[t] = min_of(low[t], height);
        high[t] = max_of(high[t], height);
      }
    }
    for (int k = 0; k < 3; ++k) {
      const double start = dot3(normal, other.place[0][k]), end = dot3(normal, other.place[1][k]);
      const double above = min_of(start - high[0], end - high[1]);
      const double below = min_of(low[0] - start, low[1] - end);
      side[k] = is_apart(above, squared, distance)   ? 1
                : is_apart(below, squared, distance) ? -1
                                                     : 0;
    }
  }
  /// Whether all corners stay on one side.
  TETWARP_HD bool all() const { return side[0] != 0 && side[1] == side[0] && side[2] == side[0]; }
};

/// Bounds of the corners of an item along an axis, at start and end.
struct AxisBounds {
  double low[2], high[2];

  TETWARP_HD AxisBounds(const ItemPoints& points, const double* axis) {
    for (int t = 0; t < 2; ++t) {
      low[t] = high[t] = dot3(axis, points.place[t][0]);
      for (int k = 1; k < 3; ++k) {
        const double height = dot3(axis, points.place[t][k]);
        low[t] = min_of(low[t], height);
        high[t] = max_of(high[t], height);
      }
    }
  }
};

/// Whether two items stay apart along the line between their middles at the start.
TETWARP_HD bool middles_apart(const ItemPoints& a, const ItemPoints& b, double distance) {
  double axis[3];
  for (int i = 0; i < 3; ++i) {
    const double first = a.place[0][0][i] + a.place[0][1][i] + a.place[0][2][i];
    axis[i] = b.place[0][0][i] + b.place[0][1][i] + b.place[0][2][i] - first;
  }
  const AxisBounds below(a, axis), above(b, axis);
  const double separation = min_of(above.low[0] - below.high[0], above.low[1] - below.high[1]);
  return is_apart(separation, dot3(axis, axis), distance);
}

/// Whether all features of two triangles that share the corners k of a and l of b, but no other
/// ones, stay apart if they do not have this corner: a plane through it lies between the triangles,
/// and the other corners are farther than `distance` from the plane.
TETWARP_HD bool fans_apart(
    const ItemPoints& a, int k, const ItemPoints& b, int l, double distance) {
  const int ends_a[2] = {(k + 1) % 3, (k + 2) % 3}, ends_b[2] = {(l + 1) % 3, (l + 2) % 3};
  double axis[3];
  for (int i = 0; i < 3; ++i) {
    axis[i] = b.place[0][ends_b[0]][i] + b.place[0][ends_b[1]][i] - a.place[0][ends_a[0]][i] -
              a.place[0][ends_a[1]][i];
  }
  const double squared = dot3(axis, axis);
  double least = 0;
  for (int t = 0; t < 2; ++t) {
    const double middle = dot3(axis, a.place[t][k]);
    for (int n = 0; n < 2; ++n) {
      const double above = dot3(axis, b.place[t][ends_b[n]]) - middle;
      const double below = middle - dot3(axis, a.place[t][ends_a[n]]);
      const double own = min_of(above, below);
      least = t == 0 && n == 0 ? own : min_of(least, own);
    }
  }
  return is_apart(least, squared, distance);
}

/// Whether edges k of a and l of b stay apart along the normal to both at the start.
TETWARP_HD bool edges_apart(
    const ItemPoints& a, int k, const ItemPoints& b, int l, double distance) {
  const int ends_a[2] = {k, (k + 1) % a.count}, ends_b[2] = {l, (l + 1) % b.count};
  double p[3], q[3], axis[3];
  for (int i = 0; i < 3; ++i) {
    p[i] = a.place[0][ends_a[1]][i] - a.place[0][ends_a[0]][i];
    q[i] = b.place[0][ends_b[1]][i] - b.place[0][ends_b[0]][i];
  }
  cross3(p, q, axis);
  double above = 0, below = 0;
  for (int t = 0; t < 2; ++t) {
    const double a0 = dot3(axis, a.place[t][ends_a[0]]), a1 = dot3(axis, a.place[t][ends_a[1]]);
    const double b0 = dot3(axis, b.place[t][ends_b[0]]), b1 = dot3(axis, b.place[t][ends_b[1]]);
    const double up = min_of(b0, b1) - max_of(a0, a1), down = min_of(a0, a1) - max_of(b0, b1);
    above = t == 0 ? up : min_of(above, up);
    below = t == 0 ? down : min_of(below, down);
  }
  const double squared = dot3(axis, axis);
  return is_apart(above, squared, distance) || is_apart(below, squared, distance);
}

}  // namespace tetwarp

#include "tests/oracles/triangle_intersection.hpp"

#include <algorithm>

#include "tests/oracles/exact_sign.hpp"

namespace tetwarp::reference {
namespace {

using Point2 = std::array<double, 2>;

Point2 without(const Point3& p, std::size_t axis) {
  return {p[(axis + 1) % 3], p[(axis + 2) % 3]};
}

/// Whether p, on the line through a and b, is between them.
template <class Point>
bool is_between(const Point& p, const Point& a, const Point& b) {
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (p[i] < std::min(a[i], b[i]) || p[i] > std::max(a[i], b[i])) return false;
  }
  return true;
}

/// Closed segments pq and ab in a plane, also of length 0.
bool segments_cross(const Point2& p, const Point2& q, const Point2& a, const Point2& b) {
  const int a_side = orientation(p, q, a), b_side = orientation(p, q, b);
  const int p_side = orientation(a, b, p), q_side = orientation(a, b, q);
  if (a_side * b_side < 0 && p_side * q_side < 0) return true;
  return (a_side == 0 && is_between(a, p, q)) || (b_side == 0 && is_between(b, p, q)) ||
         (p_side == 0 && is_between(p, a, b)) || (q_side == 0 && is_between(q, a, b));
}

bool is_inside(const Point2& p, const Point2& a, const Point2& b, const Point2& c) {
  const int s = orientation(a, b, p), t = orientation(b, c, p), u = orientation(c, a, p);
  return (s >= 0 && t >= 0 && u >= 0) || (s <= 0 && t <= 0 && u <= 0);
}

/// Segments in space. Four points that are not in one plane do not cross; others cross where their
/// projections along an axis do that keeps them apart.
bool segments_cross(const Point3& p, const Point3& q, const Point3& a, const Point3& b) {
  if (orientation(p, q, a, b) != 0) return false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Point2 p2 = without(p, axis), q2 = without(q, axis);
    const Point2 a2 = without(a, axis), b2 = without(b, axis);
    const bool keeps = orientation(p2, q2, a2) != 0 || orientation(p2, q2, b2) != 0 ||
                       orientation(a2, b2, p2) != 0 || orientation(a2, b2, q2) != 0;
    if (keeps) return segments_cross(p2, q2, a2, b2);
  }
  return is_between(a, p, q) || is_between(b, p, q) || is_between(p, a, b) || is_between(q, a, b);
}

bool segment_meets(const Point3& p, const Point3& q, const Triangle& t) {
  const int p_side = orientation(t[0], t[1], t[2], p), q_side = orientation(t[0], t[1], t[2], q);
  if (p_side * q_side > 0) return false;
  if (p_side != q_side) {
    const int s = orientation(p, q, t[0], t[1]), u = orientation(p, q, t[1], t[2]),
              v = orientation(p, q, t[2], t[0]);
    return (s >= 0 && u >= 0 && v >= 0) || (s <= 0 && u <= 0 && v <= 0);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Point2 a = without(t[0], axis), b = without(t[1], axis), c = without(t[2], axis);
    if (orientation(a, b, c) == 0) continue;
    const Point2 p2 = without(p, axis), q2 = without(q, axis);
    return is_inside(p2, a, b, c) || is_inside(q2, a, b, c) || segments_cross(p2, q2, a, b) ||
           segments_cross(p2, q2, b, c) || segments_cross(p2, q2, c, a);
  }
  return segments_cross(p, q, t[0], t[1]) || segments_cross(p, q, t[1], t[2]) ||
         segments_cross(p, q, t[2], t[0]);
}

}  // namespace

bool triangles_intersect(const Triangle& a, const Triangle& b) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (segment_meets(a[i], a[(i + 1) % 3], b)) return true;
    if (segment_meets(b[i], b[(i + 1) % 3], a)) return true;
  }
  return false;
}

}  // namespace tetwarp::reference

/// @file point3.hpp
/// Arithmetic of points and vectors.
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <tetwarp/volume.hpp>

namespace tetwarp {

inline Point3 plus(const Point3& a, const Point3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Point3 minus(const Point3& a, const Point3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
/// a - b of lists of the same size.
inline std::vector<Point3> differences(const std::vector<Point3>& a, const std::vector<Point3>& b) {
  std::vector<Point3> all(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) all[i] = minus(a[i], b[i]);
  return all;
}
inline Point3 times(double factor, const Point3& a) {
  return {factor * a[0], factor * a[1], factor * a[2]};
}
inline double dot(const Point3& a, const Point3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Point3 cross(const Point3& a, const Point3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double norm(const Point3& a) {
  return std::hypot(a[0], a[1], a[2]);
}
/// Of length 1; of a zero vector zero.
inline Point3 unit(const Point3& a) {
  const double size = norm(a);
  return size > 0 ? times(1 / size, a) : a;
}
inline bool is_finite(const Point3& a) {
  return std::isfinite(a[0]) && std::isfinite(a[1]) && std::isfinite(a[2]);
}

/// Volume of a tetrahedron, positive if its nodes are in right-handed order.
inline double tet_volume(const Point3& a, const Point3& b, const Point3& c, const Point3& d) {
  return dot(minus(b, a), cross(minus(c, a), minus(d, a))) / 6;
}

/// A box along the axes.
struct Bounds {
  Point3 low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
             std::numeric_limits<double>::infinity()};
  Point3 high{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
              -std::numeric_limits<double>::infinity()};

  void include(const Point3& x) {
    for (std::size_t d = 0; d < 3; ++d) {
      low[d] = std::fmin(low[d], x[d]);
      high[d] = std::fmax(high[d], x[d]);
    }
  }
};

/// The smallest box of points; of none: low above high.
inline Bounds bounds_of(const std::vector<Point3>& points) {
  Bounds bounds;
  for (const Point3& x : points) bounds.include(x);
  return bounds;
}

/// The element of an index that is known not to be negative.
template <class T>
inline const T& at(const std::vector<T>& list, std::int32_t index) {
  return list[static_cast<std::size_t>(index)];
}

}  // namespace tetwarp

/// @file vector3.hpp
/// Vectors of three numbers.
#pragma once
#include <cmath>

#include <tetwarp/volume.hpp>

namespace tetwarp::vec {

inline Point3 add(const Point3& a, const Point3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Point3 subtract(const Point3& a, const Point3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Point3 scaled(const Point3& a, double factor) {
  return {factor * a[0], factor * a[1], factor * a[2]};
}
inline double dot(const Point3& a, const Point3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Point3 cross(const Point3& a, const Point3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double length(const Point3& a) {
  return std::hypot(a[0], a[1], a[2]);
}
/// Of length 1; of a zero vector zero.
inline Point3 unit(const Point3& a) {
  const double size = length(a);
  return size > 0 ? scaled(a, 1 / size) : a;
}

}  // namespace tetwarp::vec

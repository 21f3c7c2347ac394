/// @file vec3.hpp
/// Points and vectors of stages in float64. Functions are those of host/base/point3.hpp.
#pragma once
#include <cmath>
#include <cstdint>

#include "kernels/base/view.hpp"

namespace tetwarp {

struct Vec3 {
  double x[3];

  TETWARP_HD double operator[](int i) const { return x[i]; }
  TETWARP_HD double& operator[](int i) { return x[i]; }
  bool operator==(const Vec3&) const = default;
};

/// The point of a number.
TETWARP_HD Vec3 vec3_at(View<const double> points, std::int64_t i) {
  return {points[3 * i], points[3 * i + 1], points[3 * i + 2]};
}
TETWARP_HD Vec3 vec3_of(const double* x) {
  return {x[0], x[1], x[2]};
}

TETWARP_HD Vec3 plus(const Vec3& a, const Vec3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
TETWARP_HD Vec3 minus(const Vec3& a, const Vec3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
TETWARP_HD Vec3 times(double factor, const Vec3& a) {
  return {factor * a[0], factor * a[1], factor * a[2]};
}
/// a + s (b - a)
TETWARP_HD Vec3 lerp(const Vec3& a, const Vec3& b, double s) {
  return plus(a, times(s, minus(b, a)));
}
TETWARP_HD double dot(const Vec3& a, const Vec3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
TETWARP_HD Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
TETWARP_HD double norm(const Vec3& a) {
#if defined(__CUDA_ARCH__)
  return norm3d(a[0], a[1], a[2]);
#else
  return std::hypot(a[0], a[1], a[2]);
#endif
}
/// Of length 1; of a zero vector zero.
TETWARP_HD Vec3 unit(const Vec3& a) {
  const double size = norm(a);
  return size > 0 ? times(1 / size, a) : a;
}
/// A unit vector across a direction.
TETWARP_HD Vec3 any_across(const Vec3& direction) {
  int axis = 0;
  for (int i = 1; i < 3; ++i) {
    if (fabs(direction[i]) < fabs(direction[axis])) axis = i;
  }
  Vec3 along{{0, 0, 0}};
  along[axis] = 1;
  return unit(cross(direction, cross(along, direction)));
}

}  // namespace tetwarp

/// @file lane_math.hpp
/// Functions that stages use on numbers and, with the overloads of
/// host/simulate/step/cpu/lanes.hpp, on vectors of numbers; small matrices of either. Matrices are
/// row-major, [9].
#pragma once
#include "kernels/base/hd.hpp"

namespace tetwarp {

TETWARP_HD double select(bool condition, double yes, double no) {
  return condition ? yes : no;
}
TETWARP_HD float select(bool condition, float yes, float no) {
  return condition ? yes : no;
}
TETWARP_HD double root_of(double x) {
  return sqrt(x);
}
TETWARP_HD float root_of(float x) {
  return sqrtf(x);
}
TETWARP_HD bool any_of(bool condition) {
  return condition;
}

template <class Real>
TETWARP_HD Real magnitude_of(Real x) {
  return select(x < Real(0.0), -x, x);
}
template <class Real>
TETWARP_HD Real larger_of(Real a, Real b) {
  return select(a < b, b, a);
}

template <class Real>
TETWARP_HD Real dot3(const Real* a, const Real* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class Real>
TETWARP_HD void cross3(const Real* a, const Real* b, Real* c) {
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}
/// y = A x; y is not x.
template <class Real>
TETWARP_HD void multiply3(const Real* a, const Real* x, Real* y) {
  for (int i = 0; i < 3; ++i) y[i] = a[3 * i] * x[0] + a[3 * i + 1] * x[1] + a[3 * i + 2] * x[2];
}
/// y = A^T x; y is not x.
template <class Real>
TETWARP_HD void multiply3_transposed(const Real* a, const Real* x, Real* y) {
  for (int i = 0; i < 3; ++i) y[i] = a[i] * x[0] + a[3 + i] * x[1] + a[6 + i] * x[2];
}
/// C = A B; C is neither of them.
template <class Real>
TETWARP_HD void product3(const Real* a, const Real* b, Real* c) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      c[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
    }
  }
}
/// C = A^T B; C is neither of them.
template <class Real>
TETWARP_HD void product3_transposed(const Real* a, const Real* b, Real* c) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      c[3 * i + j] = a[i] * b[j] + a[3 + i] * b[3 + j] + a[6 + i] * b[6 + j];
    }
  }
}

/// Matrix of a unit quaternion w, x, y, z.
template <class Real>
TETWARP_HD void matrix_of_quaternion(const Real* q, Real* r) {
  const Real two = Real(2.0), one = Real(1.0);
  const Real x = two * q[1], y = two * q[2], z = two * q[3];
  const Real wx = x * q[0], wy = y * q[0], wz = z * q[0];
  const Real xx = x * q[1], xy = y * q[1], xz = z * q[1];
  const Real yy = y * q[2], yz = z * q[2], zz = z * q[3];
  r[0] = one - (yy + zz), r[1] = xy - wz, r[2] = xz + wy;
  r[3] = xy + wz, r[4] = one - (xx + zz), r[5] = yz - wx;
  r[6] = xz - wy, r[7] = yz + wx, r[8] = one - (xx + yy);
}

/// Scales a quaternion to length one; not one of length zero.
template <class Real>
TETWARP_HD void normalize_quaternion(Real* q) {
  const Real square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  const Real factor = Real(1.0) / root_of(square);
  for (int i = 0; i < 4; ++i) q[i] = q[i] * factor;
}

/// c = a b of quaternions; c is neither of them.
template <class Real>
TETWARP_HD void quaternion_product(const Real* a, const Real* b, Real* c) {
  c[0] = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
  c[1] = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
  c[2] = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1];
  c[3] = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
}

}  // namespace tetwarp

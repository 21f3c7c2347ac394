/// @file tet_rotation.hpp
/// The rotation R that maximizes tr(R^T F): the proper rotation nearest to a deformation gradient.
///
/// Stateless: a closed form, the largest root of a quartic, followed by one Newton step; near ties
/// of two singular values of opposite sign a singular value decomposition. Accurate to rounding
/// also for flat and inverted F. Sources: Higham and Noferini 2016 (quartic of the quaternion
/// form); Horn 1987.
#pragma once
#include <type_traits>

#include "kernels/body/lane_math.hpp"

namespace tetwarp {

/// Least zeta / (|F|^2 l) of the closed form: with less, float64 does not resolve the rotation.
template <class Real>
constexpr double least_separation = std::is_same_v<Real, float> ? 2e-3 : 1e-5;
/// The same where det F < 0.
constexpr double least_inverted_separation = 2e-2;

/// Quaternion of a matrix that is a rotation up to rounding.
template <class Real>
TETWARP_HD void quaternion_of_matrix(const Real* r, Real* q) {
  const Real one = Real(1.0);
  const Real rows[4][4] = {{one + r[0] + r[4] + r[8], r[7] - r[5], r[2] - r[6], r[3] - r[1]},
                           {r[7] - r[5], one + r[0] - r[4] - r[8], r[3] + r[1], r[2] + r[6]},
                           {r[2] - r[6], r[3] + r[1], one - r[0] + r[4] - r[8], r[7] + r[5]},
                           {r[3] - r[1], r[2] + r[6], r[7] + r[5], one - r[0] - r[4] + r[8]}};
  Real largest = rows[0][0];
  for (int j = 0; j < 4; ++j) q[j] = rows[0][j];
  for (int i = 1; i < 4; ++i) {
    const auto is_larger = largest < rows[i][i];
    largest = select(is_larger, rows[i][i], largest);
    for (int j = 0; j < 4; ++j) q[j] = select(is_larger, rows[i][j], q[j]);
  }
  normalize_quaternion(q);
}

/// omega = H^-1 g of Newton's step on tr(R^T F), in the frame that R maps from.
/// @param s  S = R^T F
/// @returns  where H is positive enough for the step to be used
template <class Real>
TETWARP_HD auto newton_turn(const Real* s, Real* omega) {
  const Real half = Real(0.5);
  const Real h00 = s[4] + s[8], h11 = s[0] + s[8], h22 = s[0] + s[4];
  const Real h01 = -half * (s[1] + s[3]), h02 = -half * (s[2] + s[6]), h12 = -half * (s[5] + s[7]);
  const Real g[3] = {s[7] - s[5], s[2] - s[6], s[3] - s[1]};
  const Real c00 = h11 * h22 - h12 * h12, c01 = h02 * h12 - h01 * h22, c02 = h01 * h12 - h02 * h11;
  const Real c11 = h00 * h22 - h02 * h02, c12 = h01 * h02 - h00 * h12, c22 = h00 * h11 - h01 * h01;
  const Real det = h00 * c00 + h01 * c01 + h02 * c02;
  const Real inverse = Real(1.0) / det;
  omega[0] = (c00 * g[0] + c01 * g[1] + c02 * g[2]) * inverse;
  omega[1] = (c01 * g[0] + c11 * g[1] + c12 * g[2]) * inverse;
  omega[2] = (c02 * g[0] + c12 * g[1] + c22 * g[2]) * inverse;
  return dot3(omega, omega) < Real(0.1);  // false for NaN
}

/// Writes q (1, omega / 2), normalized, where `use` is true.
template <class Real, class Condition>
TETWARP_HD void turn_quaternion(Condition use, const Real* omega, Real* q) {
  const Real step[4] = {Real(1.0), Real(0.5) * omega[0], Real(0.5) * omega[1],
                        Real(0.5) * omega[2]};
  Real next[4];
  quaternion_product(q, step, next);
  normalize_quaternion(next);
  for (int i = 0; i < 4; ++i) q[i] = select(use, next[i], q[i]);
}

/// @param f  F, [9]
/// @param r  out: R, exactly a matrix of a unit quaternion; undefined where the result is false
/// @returns  where R is valid; elsewhere rotation_by_svd() is needed
template <class Real>
TETWARP_HD auto rotation_by_quartic(const Real* unscaled, Real* r) {
  Real largest = magnitude_of(unscaled[0]);
  for (int i = 1; i < 9; ++i) largest = larger_of(largest, magnitude_of(unscaled[i]));
  const Real scale = Real(1.0) / largest;
  Real f[9], c[9];
  for (int i = 0; i < 9; ++i) f[i] = unscaled[i] * scale;
  cross3(f + 3, f + 6, c);  // rows of the cofactor matrix
  cross3(f + 6, f, c + 3);
  cross3(f, f + 3, c + 6);
  const Real d = dot3(f, c);
  const Real f2 = dot3(f, f) + dot3(f + 3, f + 3) + dot3(f + 6, f + 6);
  const Real c2 = dot3(c, c) + dot3(c + 3, c + 3) + dot3(c + 6, c + 6);

  // l = s1 + s2 + s3: the largest root of (l^2 - f2)^2 - 8 l d - 4 c2, by Newton from above.
  Real l = root_of(f2 + Real(2.0) * root_of(Real(3.0) * c2));
  auto moves = l > Real(0.0);
  const Real enough = Real(std::is_same_v<Real, float> ? 1e-4 : 1e-8);
  for (int i = 0; i < 12 && any_of(moves); ++i) {
    const Real m = l * l - f2;
    const Real value = m * m - Real(8.0) * (l * d) - Real(4.0) * c2;
    const Real slope = Real(4.0) * (l * m) - Real(8.0) * d;
    const Real step = value / slope;
    const auto is_down = step > Real(0.0);
    l = select(moves, select(is_down, l - step, l), l);
    moves = moves && is_down && step > enough * l;
  }
  const Real k = Real(0.5) * (l * l - f2);
  const Real zeta = k * l - d;  // (s1 + s2) (s2 + s3) (s3 + s1)
  const Real unit = f2 * l;
  const auto is_valid = zeta > Real(least_separation<Real>) * unit &&
                        (d > Real(0.0) || zeta > Real(least_inverted_separation) * unit);

  Real ft_f[9], cubic[9];
  product3_transposed(f, f, ft_f);
  product3(f, ft_f, cubic);
  const Real inverse = Real(1.0) / zeta;
  for (int i = 0; i < 9; ++i) r[i] = ((k + f2) * f[i] + l * c[i] - cubic[i]) * inverse;
  Real q[4], s[9], omega[3];
  quaternion_of_matrix(r, q);
  matrix_of_quaternion(q, r);
  product3_transposed(r, f, s);
  const auto use = newton_turn(s, omega);
  turn_quaternion(use, omega, q);
  matrix_of_quaternion(q, r);
  return is_valid && r[0] <= Real(2.0);  // false for NaN
}

/// A unit vector perpendicular to the unit vector a.
TETWARP_HD void perpendicular_to(const double* a, double* b) {
  int least = 0;
  for (int i = 1; i < 3; ++i) {
    if (fabs(a[i]) < fabs(a[least])) least = i;
  }
  const double axis[3] = {least == 0 ? 1.0 : 0.0, least == 1 ? 1.0 : 0.0, least == 2 ? 1.0 : 0.0};
  cross3(a, axis, b);
  const double inverse = 1 / sqrt(dot3(b, b));
  for (int i = 0; i < 3; ++i) b[i] *= inverse;
}

/// Rotates the columns of A, and those of V alike, until they are orthogonal: A = U S, V
/// orthogonal. Small singular values keep their relative accuracy. Source: Hestenes 1958.
/// @param a, v  in: F and the identity, as columns [3][3]
TETWARP_HD void one_sided_jacobi(double (*a)[3], double (*v)[3]) {
  bool has_turned = true;
  for (int sweep = 0; sweep < 12 && has_turned; ++sweep) {
    has_turned = false;
    for (int p = 0; p < 2; ++p) {
      for (int q = p + 1; q < 3; ++q) {
        const double pp = dot3(a[p], a[p]), qq = dot3(a[q], a[q]), pq = dot3(a[p], a[q]);
        if (!(fabs(pq) > 0x1p-52 * sqrt(pp) * sqrt(qq))) continue;
        has_turned = true;
        const double slope = (qq - pp) / (2 * pq);
        const double tangent = copysign(1 / (fabs(slope) + sqrt(slope * slope + 1)), slope);
        const double cosine = 1 / sqrt(tangent * tangent + 1), sine = tangent * cosine;
        for (int i = 0; i < 3; ++i) {
          const double a_p = a[p][i], a_q = a[q][i], v_p = v[p][i], v_q = v[q][i];
          a[p][i] = cosine * a_p - sine * a_q;
          a[q][i] = sine * a_p + cosine * a_q;
          v[p][i] = cosine * v_p - sine * v_q;
          v[q][i] = sine * v_p + cosine * v_q;
        }
      }
    }
  }
}

/// Proper rotation u1 v1^T + u2 v2^T + (u1 x u2) (v1 x v2)^T of the two largest singular values of
/// F; the sign of det F is thereby on the smallest.
/// @param f  entries of at most 1 in magnitude, one of them 1
TETWARP_HD void rotation_of_singular_vectors(const double* f, double* r) {
  double a[3][3], v[3][3], square[3];
  for (int k = 0; k < 9; ++k) a[k % 3][k / 3] = f[k], v[k % 3][k / 3] = k % 4 == 0 ? 1 : 0;
  one_sided_jacobi(a, v);
  int first = 0, last = 0;
  for (int i = 0; i < 3; ++i) {
    square[i] = dot3(a[i], a[i]);
    if (square[i] > square[first]) first = i;
    if (square[i] <= square[last]) last = i;
  }
  const int second = 3 - first - last;
  double u1[3], u2[3], u3[3], v3[3];
  for (int i = 0; i < 3; ++i) u1[i] = a[first][i] / sqrt(square[first]);
  if (square[second] > 1e-290) {
    for (int i = 0; i < 3; ++i) u2[i] = a[second][i] / sqrt(square[second]);
  } else {
    perpendicular_to(u1, u2);
  }
  cross3(u1, u2, u3);
  cross3(v[first], v[second], v3);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      r[3 * i + j] = u1[i] * v[first][j] + u2[i] * v[second][j] + u3[i] * v3[j];
    }
  }
}

/// R by a singular value decomposition and up to three Newton steps, for any F. F = 0 and F with
/// infinite or undefined entries: the identity.
TETWARP_HD_RARE void rotation_by_svd(const double* unscaled, double* r) {
  for (int i = 0; i < 9; ++i) r[i] = i % 4 == 0 ? 1 : 0;
  double largest = 0, sum = 0;
  for (int i = 0; i < 9; ++i) {
    largest = max_of(largest, fabs(unscaled[i]));
    sum += fabs(unscaled[i]);
  }
  if (!(largest > 0) || !(sum < 1e300)) return;
  double f[9], q[4], s[9], omega[3];
  for (int i = 0; i < 9; ++i) f[i] = unscaled[i] / largest;
  rotation_of_singular_vectors(f, r);
  quaternion_of_matrix(r, q);
  matrix_of_quaternion(q, r);
  product3_transposed(r, f, s);
  for (int step = 0; step < 3; ++step) {
    if (!newton_turn(s, omega)) return;
    double next_q[4] = {q[0], q[1], q[2], q[3]}, next_r[9], next_s[9];
    turn_quaternion(true, omega, next_q);
    matrix_of_quaternion(next_q, next_r);
    product3_transposed(next_r, f, next_s);
    if (!(next_s[0] + next_s[4] + next_s[8] > s[0] + s[4] + s[8])) return;
    for (int i = 0; i < 4; ++i) q[i] = next_q[i];
    for (int i = 0; i < 9; ++i) r[i] = next_r[i], s[i] = next_s[i];
  }
}

/// @param f  F, [9]
/// @param r  out: R, [9]
TETWARP_HD void tet_rotation(const double* f, double* r) {
  if (!rotation_by_quartic(f, r)) rotation_by_svd(f, r);
}
/// In float32; what float32 does not resolve (needles, ties) is left to float64.
TETWARP_HD void tet_rotation(const float* f, float* r) {
  if (rotation_by_quartic(f, r)) return;
  double wide[9], result[9];
  for (int i = 0; i < 9; ++i) wide[i] = static_cast<double>(f[i]);
  tet_rotation(wide, result);
  for (int i = 0; i < 9; ++i) r[i] = static_cast<float>(result[i]);
}

}  // namespace tetwarp

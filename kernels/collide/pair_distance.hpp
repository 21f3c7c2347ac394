/// @file pair_distance.hpp
/// Closest points of a point and a triangle, and of two segments, also of degenerate ones.
///
/// Each function takes the closest point of the boundary first and measures the inside from there:
/// the differences that decide are then as small as the distance itself, so that needles and nearly
/// parallel segments give distances that err by a few rounding errors of the lengths, and not by
/// the root of the rounding error.
#pragma once
#include <cmath>
#include <cstdint>

#include "kernels/base/hd.hpp"

namespace tetwarp {

TETWARP_HD double dot3(const double* a, const double* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
TETWARP_HD void minus3(const double* a, const double* b, double* difference) {
  for (int i = 0; i < 3; ++i) difference[i] = a[i] - b[i];
}
TETWARP_HD void cross3(const double* a, const double* b, double* cross) {
  cross[0] = a[1] * b[2] - a[2] * b[1];
  cross[1] = a[2] * b[0] - a[0] * b[2];
  cross[2] = a[0] * b[1] - a[1] * b[0];
}

/// The point a + s (b - a) of a segment nearest to p; s is 0 where both ends are equal.
/// @returns the squared distance
TETWARP_HD double vertex_edge_square(const double* p, const double* a, const double* b, double* s) {
  double ab[3], ap[3];
  minus3(b, a, ab), minus3(p, a, ap);
  const double length = dot3(ab, ab);
  const double t = length > 0 ? dot3(ap, ab) / length : 0;
  *s = t < 0 ? 0 : t > 1 ? 1 : t;
  for (int i = 0; i < 3; ++i) ap[i] -= *s * ab[i];
  return dot3(ap, ap);
}

/// @param weight  out: of the triangle's closest point, [3], each 0 to 1
/// @returns the distance of p from the triangle a, b, c
TETWARP_HD double vertex_face_distance(
    const double* p, const double* a, const double* b, const double* c, double* weight) {
  const double* const corner[3] = {a, b, c};
  double best = -1;
  for (int k = 0; k < 3; ++k) {
    double s;
    const int next = (k + 1) % 3;
    const double square = vertex_edge_square(p, corner[k], corner[next], &s);
    if (best >= 0 && !(square < best)) continue;
    best = square;
    weight[k] = 1 - s, weight[next] = s, weight[(k + 2) % 3] = 0;
  }
  double u[3], v[3], w[3], n[3], m[3];
  minus3(b, a, u), minus3(c, a, v);
  cross3(u, v, n);
  const double square = dot3(n, n);
  if (!(square > 0)) return std::sqrt(best);
  minus3(p, a, w);
  for (int i = 0; i < 3; ++i) w[i] -= weight[1] * u[i] + weight[2] * v[i];
  cross3(w, v, m);
  const double step_b = dot3(m, n) / square;
  cross3(u, w, m);
  const double step_c = dot3(m, n) / square;
  const double at_b = weight[1] + step_b, at_c = weight[2] + step_c, at_a = 1 - at_b - at_c;
  if (!(at_a > 0 && at_b > 0 && at_c > 0)) return std::sqrt(best);
  for (int i = 0; i < 3; ++i) w[i] -= step_b * u[i] + step_c * v[i];
  const double inside = dot3(w, w);
  if (!(inside < best)) return std::sqrt(best);
  weight[0] = at_a, weight[1] = at_b, weight[2] = at_c;
  return std::sqrt(inside);
}

/// @param s, t  out: closest points p0 + s (p1 - p0) and q0 + t (q1 - q0), 0 to 1
/// @returns the distance of the segments p0, p1 and q0, q1
TETWARP_HD double edge_edge_distance(
    const double* p0, const double* p1, const double* q0, const double* q1, double* s, double* t) {
  double own;
  double best = vertex_edge_square(p0, q0, q1, t);
  *s = 0;
  double square = vertex_edge_square(p1, q0, q1, &own);
  if (square < best) best = square, *s = 1, *t = own;
  square = vertex_edge_square(q0, p0, p1, &own);
  if (square < best) best = square, *s = own, *t = 0;
  square = vertex_edge_square(q1, p0, p1, &own);
  if (square < best) best = square, *s = own, *t = 1;
  double u[3], v[3], w[3], n[3], m[3];
  minus3(p1, p0, u), minus3(q1, q0, v);
  cross3(u, v, n);
  square = dot3(n, n);
  if (!(square > 0)) return std::sqrt(best);
  minus3(p0, q0, w);
  for (int i = 0; i < 3; ++i) w[i] += *s * u[i] - *t * v[i];
  cross3(v, w, m);
  const double step_s = dot3(m, n) / square;
  cross3(u, w, m);
  const double step_t = dot3(m, n) / square;
  const double at_s = *s + step_s, at_t = *t + step_t;
  if (!(at_s > 0 && at_s < 1 && at_t > 0 && at_t < 1)) return std::sqrt(best);
  for (int i = 0; i < 3; ++i) w[i] += step_s * u[i] - step_t * v[i];
  const double inside = dot3(w, w);
  if (inside < best) best = inside, *s = at_s, *t = at_t;
  return std::sqrt(best);
}

}  // namespace tetwarp

#include "tests/collide/cubic_ccd.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/point3.hpp"

namespace tetwarp::test {
namespace {

/// Of the three differences of four points at a time.
double volume_at(const MovingPair& pair, double time) {
  const auto x = places_at(pair, time);
  return dot(minus(x[0], x[1]), cross(minus(x[2], x[1]), minus(x[3], x[1])));
}

/// Roots in 0 to 1 of c0 + c1 t + c2 t^2 + c3 t^3, by bisection between the roots of the
/// derivative.
std::vector<double> roots_of(const std::array<double, 4>& c) {
  const auto value = [&](double t) { return c[0] + t * (c[1] + t * (c[2] + t * c[3])); };
  std::vector<double> ends = {0, 1};
  const double square = c[2] * c[2] - 3 * c[3] * c[1];
  if (square >= 0) {
    const double q = -(c[2] + std::copysign(std::sqrt(square), c[2]));
    for (const double t : {q / (3 * c[3]), c[1] / q}) {
      if (t > 0 && t < 1) ends.push_back(t);
    }
  }
  std::sort(ends.begin(), ends.end());
  std::vector<double> roots;
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    double low = ends[k], high = ends[k + 1];
    if ((value(low) < 0) == (value(high) < 0)) continue;
    for (int step = 0; step < 60; ++step) {
      const double middle = (low + high) / 2;
      ((value(low) < 0) == (value(middle) < 0) ? low : high) = middle;
    }
    roots.push_back(low);
  }
  return roots;
}

/// Whether the coordinates of the coplanar points' crossing are within the features.
bool meets(const std::array<Point3, 4>& x, bool edges, double tolerance) {
  const Point3 u = edges ? minus(x[1], x[0]) : minus(x[2], x[1]);
  const Point3 v = edges ? minus(x[2], x[3]) : minus(x[3], x[1]);
  const Point3 w = edges ? minus(x[2], x[0]) : minus(x[0], x[1]);
  const Point3 n = cross(u, v);
  const double s = dot(cross(w, v), n) / dot(n, n), t = dot(cross(u, w), n) / dot(n, n);
  const auto in = [&](double share) { return share >= -tolerance && share <= 1 + tolerance; };
  return edges ? in(s) && in(t) : s >= -tolerance && t >= -tolerance && s + t <= 1 + tolerance;
}

}  // namespace

double cubic_time(const MovingPair& pair, bool edges, double tolerance) {
  const double f0 = volume_at(pair, 0), f1 = volume_at(pair, 1), f2 = volume_at(pair, -1),
               f3 = volume_at(pair, 2);
  const double c2 = (f1 + f2) / 2 - f0, c3 = (f3 - f0 - 4 * c2 - (f1 - f2)) / 6;
  for (const double root : roots_of({f0, (f1 - f2) / 2 - c3, c2, c3})) {
    if (meets(places_at(pair, root), edges, tolerance)) return root;
  }
  return 2;
}

}  // namespace tetwarp::test

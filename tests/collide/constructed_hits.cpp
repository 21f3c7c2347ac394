#include "tests/collide/constructed_hits.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/point3.hpp"

namespace tetwarp::test {
namespace {

using Points = std::array<Point3, 4>;

class HitMaker {
 public:
  HitMaker(HitKind kind, bool edges, std::mt19937_64& random)
      : kind_(kind), edges_(edges), random_(random) {}

  MovingPair make() {
    if (kind_ == HitKind::grazing) {
      graze();
    } else {
      meet();
    }
    MovingPair pair;
    pair.time = kind_ == HitKind::at_end ? 1 : share();
    for (std::size_t k = 0; k < 4; ++k) {
      pair.start[k] = minus(place_[k], times(pair.time, motion_[k]));
      pair.end[k] = plus(place_[k], times(1 - pair.time, motion_[k]));
    }
    if (kind_ == HitKind::offset_1e3) move(pair, 1e3);
    if (kind_ == HitKind::offset_1e6) move(pair, 1e6);
    if (kind_ == HitKind::tiny) {
      pair.size = 1e-6;
      for (auto* points : {&pair.start, &pair.end}) {
        for (Point3& p : *points) p = times(pair.size, p);
      }
    }
    return pair;
  }

 private:
  double share() { return std::uniform_real_distribution<double>()(random_); }
  Point3 vector() {
    std::normal_distribution<double> normal;
    return {normal(random_), normal(random_), normal(random_)};
  }
  Point3 unit_vector() {
    const Point3 v = vector();
    return times(1 / norm(v), v);
  }
  void move(MovingPair& pair, double far) {
    const Point3 way = times(far, unit_vector());
    for (auto* points : {&pair.start, &pair.end}) {
      for (Point3& p : *points) p = plus(p, way);
    }
  }

  /// Weights of the points in the difference that is 0 at the meeting.
  std::array<double, 4> weights() {
    const bool on_edge = kind_ == HitKind::at_edge || kind_ == HitKind::coplanar_flat ||
                         kind_ == HitKind::coplanar_tilted;
    const double s = kind_ == HitKind::at_vertex || (on_edge && edges_) ? 0 : share();
    const double t = kind_ == HitKind::at_vertex ? 0 : share();
    if (edges_) return {1 - s, s, t - 1, -t};
    const double root = std::sqrt(t), b = on_edge ? t : root * (1 - s);
    const double c = on_edge ? 0 : root * s;
    return {1, b + c - 1, -b, -c};
  }

  /// Places and motions of a meeting: side a is moved to where it is met.
  void meet() {
    for (std::size_t k = 0; k < 4; ++k) place_[k] = vector(), motion_[k] = vector();
    const std::size_t b = edges_ ? 2 : 1;
    if (kind_ == HitKind::translation) {
      for (std::size_t k = 0; k < 4; ++k) motion_[k] = motion_[k < b ? 0 : b];
    }
    if (kind_ == HitKind::coplanar_flat || kind_ == HitKind::coplanar_tilted) {
      for (auto* points : {&place_, &motion_}) {
        for (Point3& p : *points) p[2] = 0;
      }
    }
    if (kind_ == HitKind::degenerate) make_degenerate();
    const std::array<double, 4> weight = weights();
    Point3 apart{0, 0, 0};
    for (std::size_t k = 0; k < 4; ++k) apart = plus(apart, times(weight[k], place_[k]));
    for (std::size_t k = 0; k < b; ++k) place_[k] = minus(place_[k], apart);
    if (kind_ == HitKind::coplanar_tilted) tilt();
  }

  void make_degenerate() {
    const double far = 2 * share() - 1;
    for (auto* points : {&place_, &motion_}) {
      Points& p = *points;
      if (edges_) {
        p[3] = plus(p[2], times(far, minus(p[1], p[0])));
      } else {
        p[3] = plus(p[1], times(far, minus(p[2], p[1])));
      }
    }
  }

  void tilt() {
    const Point3 x = unit_vector(), other = vector();
    Point3 y = minus(other, times(dot(x, other), x));
    y = times(1 / norm(y), y);
    for (auto* points : {&place_, &motion_}) {
      for (Point3& p : *points) p = plus(times(p[0], x), times(p[1], y));
    }
  }

  /// Point 0 passes a corner of the face, or an edge, along a plane that separates both features.
  void graze() {
    const Point3 normal = unit_vector(), other = vector();
    Point3 along = minus(other, times(dot(normal, other), normal));
    const Point3 across = cross(normal, along);
    const Point3 common = vector(), nearest = times(-1e-12, normal);
    const auto on_side = [&](double side) {
      const Point3 v = vector();
      const double height = dot(v, normal);
      return plus(minus(v, times(height, normal)), times(side * (std::abs(height) + 0.1), normal));
    };
    place_ = {Point3{0, 0, 0}, nearest, plus(nearest, on_side(-1)), plus(nearest, on_side(-1))};
    if (edges_) {
      place_ = {Point3{0, 0, 0}, on_side(1), plus(nearest, across), minus(nearest, across)};
    }
    motion_.fill(common);
    for (std::size_t k = 0; k < (edges_ ? 2u : 1u); ++k) motion_[k] = plus(common, along);
  }

  HitKind kind_;
  bool edges_;
  std::mt19937_64& random_;
  Points place_{}, motion_{};
};

using Wide = long double;
using WidePoint = std::array<Wide, 3>;

WidePoint between(const WidePoint& a, const WidePoint& b, Wide s) {
  return {a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1]), a[2] + s * (b[2] - a[2])};
}

/// Distance of p from the segment a, b.
Wide segment_distance(const WidePoint& p, const WidePoint& a, const WidePoint& b) {
  Wide length = 0, along = 0, square = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    length += (b[i] - a[i]) * (b[i] - a[i]);
    along += (p[i] - a[i]) * (b[i] - a[i]);
  }
  const Wide s = length > 0 ? std::min<Wide>(std::max<Wide>(along / length, 0), 1) : 0;
  const WidePoint q = between(a, b, s);
  for (std::size_t i = 0; i < 3; ++i) square += (p[i] - q[i]) * (p[i] - q[i]);
  return std::sqrt(square);
}

}  // namespace

const std::vector<HitKind> all_hit_kinds = {
    HitKind::generic, HitKind::tiny,          HitKind::translation,     HitKind::at_vertex,
    HitKind::at_edge, HitKind::grazing,       HitKind::offset_1e3,      HitKind::offset_1e6,
    HitKind::at_end,  HitKind::coplanar_flat, HitKind::coplanar_tilted, HitKind::degenerate};

const char* name_of(HitKind kind) {
  static const char* const names[] = {"generic", "tiny",          "translation",     "at_vertex",
                                      "at_edge", "grazing",       "offset_1e3",      "offset_1e6",
                                      "at_end",  "coplanar_flat", "coplanar_tilted", "degenerate"};
  return names[static_cast<std::size_t>(kind)];
}

MovingPoints MovingPair::points() const {
  MovingPoints points{};
  for (std::size_t k = 0; k < 4; ++k) {
    points.start[k] = start[k].data();
    points.end[k] = end[k].data();
  }
  return points;
}

MovingPair constructed_hit(HitKind kind, bool edges, std::mt19937_64& random) {
  return HitMaker(kind, edges, random).make();
}

MovingPair random_pair(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  MovingPair pair;
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      pair.start[k][i] = normal(random);
      pair.end[k][i] = pair.start[k][i] + normal(random);
    }
  }
  return pair;
}

CcdResult ccd_of(const MovingPair& pair, bool edges, const CcdLimits& limits) {
  return edges ? edge_edge_ccd(pair.points(), limits) : vertex_face_ccd(pair.points(), limits);
}

std::array<Point3, 4> places_at(const MovingPair& pair, double time) {
  std::array<Point3, 4> places;
  for (std::size_t k = 0; k < 4; ++k) {
    places[k] = plus(pair.start[k], times(time, minus(pair.end[k], pair.start[k])));
  }
  return places;
}

double searched_distance(const std::array<Point3, 4>& points, bool edges) {
  WidePoint x[4];
  for (std::size_t k = 0; k < 4; ++k) x[k] = {points[k][0], points[k][1], points[k][2]};
  // The distance from the face's segment between b + s (a - b) and c + s (a - c), or from the point
  // at s of the first edge, is convex in s.
  const auto at = [&](Wide s) {
    if (edges) return segment_distance(between(x[0], x[1], s), x[2], x[3]);
    return segment_distance(x[0], between(x[2], x[1], s), between(x[3], x[1], s));
  };
  Wide low = 0, high = 1, best = std::min(at(0), at(1));
  for (int k = 0; k < 150; ++k) {
    const Wide first = low + (high - low) / 3, second = high - (high - low) / 3;
    const Wide at_first = at(first), at_second = at(second);
    best = std::min({best, at_first, at_second});
    (at_first < at_second ? high : low) = at_first < at_second ? second : first;
  }
  return static_cast<double>(best);
}

}  // namespace tetwarp::test

#include "host/collide/moving_triangles.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "host/base/point3.hpp"
#include "host/collide/exact_integer.hpp"

namespace tetwarp {
namespace {
constexpr double unit_roundoff = std::numeric_limits<double>::epsilon() / 2;
constexpr double underflow = 0x1p-1000;  // more than what products below the least number lose

using SixPoints = std::array<Point3, 6>;

SixPoints places_at(const TrianglePairMotion& pair, std::int64_t time) {
  const double t = std::ldexp(static_cast<double>(time), -time_bits);  // exact, and so is 1 - t
  SixPoints places;
  for (std::size_t p = 0; p < 6; ++p) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      places[p][axis] = (1 - t) * pair.start[p][axis] + t * pair.end[p][axis];
    }
  }
  return places;
}

/// Per axis the largest absolute coordinate of the motion.
Point3 sizes_of(const TrianglePairMotion& pair) {
  Point3 sizes{0, 0, 0};
  for (const SixPoints* places : {&pair.start, &pair.end}) {
    for (const Point3& x : *places) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        sizes[axis] = std::max(sizes[axis], std::abs(x[axis]));
      }
    }
  }
  return sizes;
}

/// Least distance along a direction from the first three points to the others.
double gap_along(const Point3& direction, const SixPoints& places) {
  double high = -std::numeric_limits<double>::infinity(), low = -high;
  for (std::size_t p = 0; p < 3; ++p) {
    high = std::max(high, dot(direction, places[p]));
    low = std::min(low, dot(direction, places[3 + p]));
  }
  return low - high;
}

/// Edges of both triangles.
std::array<Point3, 6> edges_of(const SixPoints& x) {
  return {minus(x[1], x[0]), minus(x[2], x[1]), minus(x[0], x[2]),
          minus(x[4], x[3]), minus(x[5], x[4]), minus(x[3], x[5])};
}

/// Calls visit(direction) for directions that may separate until it returns true. @returns whether
/// it did
template <class Visit>
bool any_direction(const SixPoints& x, const Visit& visit) {
  const auto either = [&](const Point3& direction) {
    return visit(direction) || visit(times(-1, direction));
  };
  const std::array<Point3, 6> edges = edges_of(x);
  const Point3 centers = minus(plus(plus(x[3], x[4]), x[5]), plus(plus(x[0], x[1]), x[2]));
  if (either(centers)) return true;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Point3 along{0, 0, 0};
    along[axis] = 1;
    if (either(along)) return true;
  }
  if (either(cross(edges[0], edges[1])) || either(cross(edges[3], edges[4]))) return true;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 3; b < 6; ++b) {
      if (either(cross(edges[a], edges[b]))) return true;
    }
  }
  // Where a corner or an edge of one is nearest to the other: differences of points, and their
  // parts that are normal to an edge.
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 3; b < 6; ++b) {
      const Point3 between = minus(x[b], x[a]);
      if (either(between)) return true;
      for (const std::size_t e : {a, b}) {
        if (either(cross(cross(edges[e], between), edges[e]))) return true;
      }
    }
  }
  return false;
}

using ExactPoint = std::array<ExactInteger, 3>;

ExactPoint difference(const ExactPoint& a, const ExactPoint& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

ExactPoint product(const ExactPoint& a, const ExactPoint& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

ExactInteger inner(const ExactPoint& a, const ExactPoint& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

bool is_zero(const ExactPoint& a) {
  return a[0].sign() == 0 && a[1].sign() == 0 && a[2].sign() == 0;
}

/// The places of a pair at a time, in integers of one unit.
std::array<ExactPoint, 6> exact_places(const TrianglePairMotion& pair, std::int64_t time) {
  int least = std::numeric_limits<int>::max();  // exponent of the last bit of any coordinate
  const auto include = [&](const SixPoints& places) {
    for (const Point3& x : places) {
      for (const double coordinate : x) {
        if (coordinate == 0) continue;
        int exponent = 0;
        std::frexp(coordinate, &exponent);
        least = std::min(least, exponent - std::numeric_limits<double>::digits);
      }
    }
  };
  if (time != end_of_time) include(pair.start);
  if (time != 0) include(pair.end);
  if (least == std::numeric_limits<int>::max()) least = 0;
  std::array<ExactPoint, 6> places;
  for (std::size_t p = 0; p < 6; ++p) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ExactInteger& x = places[p][axis];
      if (time == 0) {
        x = ExactInteger(pair.start[p][axis], -least);
      } else if (time == end_of_time) {
        x = ExactInteger(pair.end[p][axis], -least);
      } else {
        x = ExactInteger(end_of_time - time) * ExactInteger(pair.start[p][axis], -least) +
            ExactInteger(time) * ExactInteger(pair.end[p][axis], -least);
      }
    }
  }
  return places;
}

/// Whether a direction separates the first three points strictly from the others: 1 if these lie
/// ahead, -1 if they lie behind, else 0.
int separated_side(const ExactPoint& direction, const std::array<ExactPoint, 6>& places) {
  if (is_zero(direction)) return 0;
  std::array<ExactInteger, 6> along;
  for (std::size_t p = 0; p < 6; ++p) along[p] = inner(direction, places[p]);
  const auto [a_low, a_high] = std::minmax({along[0], along[1], along[2]});
  const auto [b_low, b_high] = std::minmax({along[3], along[4], along[5]});
  return a_high < b_low ? 1 : b_high < a_low ? -1 : 0;
}

/// Whether the segment from p to q certainly passes through the triangle a, b, c: four signs of
/// determinants beyond their rounding.
/// @param error  bound of the rounding of a determinant
bool pierces(const Point3& p,
             const Point3& q,
             const Point3& a,
             const Point3& b,
             const Point3& c,
             double error) {
  const auto sign = [&](const Point3& w, const Point3& x, const Point3& y, const Point3& z) {
    const double value = dot(cross(minus(w, z), minus(x, z)), minus(y, z));
    return value > error ? 1 : value < -error ? -1 : 0;
  };
  const int p_side = sign(a, b, c, p), q_side = sign(a, b, c, q);
  if (p_side * q_side >= 0) return false;
  const int s = sign(p, q, a, b), t = sign(p, q, b, c), u = sign(p, q, c, a);
  return s != 0 && s == t && t == u;
}

/// Whether rounded places certainly intersect.
bool certainly_intersect(const SixPoints& x, double size) {
  double extent = 0;
  for (const Point3& point : x) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      extent = std::max(extent, std::abs(point[axis] - x[0][axis]));
    }
  }
  // Differences of places are off by 8 u size and below 2 extent + 8 u size; a determinant is the
  // sum of six products of three of them.
  const double reach = 2 * extent + 8 * unit_roundoff * size;
  const double error = 512 * unit_roundoff * size * reach * reach + underflow;
  for (std::size_t e = 0; e < 3; ++e) {
    const std::size_t next = (e + 1) % 3;
    if (pierces(x[e], x[next], x[3], x[4], x[5], error)) return true;
    if (pierces(x[3 + e], x[3 + next], x[0], x[1], x[2], error)) return true;
  }
  return false;
}

/// A direction that separates the triangles strictly; nothing if they intersect. See
/// do_intersect().
std::optional<ExactPoint> exact_direction(const std::array<ExactPoint, 6>& x) {
  std::vector<ExactPoint> edges{difference(x[1], x[0]), difference(x[2], x[1]),
                                difference(x[0], x[2]), difference(x[4], x[3]),
                                difference(x[5], x[4]), difference(x[3], x[5])};
  std::vector<ExactPoint> normals;
  const auto add_normals = [&](std::size_t i) {
    for (std::size_t k = 0; k < i; ++k) normals.push_back(product(edges[i], edges[k]));
  };
  for (std::size_t i = 1; i < edges.size(); ++i) add_normals(i);
  bool spans_space = false;
  for (const ExactPoint& normal : normals) {
    if (separated_side(normal, x) != 0) return normal;
    for (const ExactPoint& edge : edges) {
      spans_space = spans_space || inner(normal, edge).sign() != 0;
    }
  }
  if (spans_space) return {};
  edges.push_back(difference(x[3], x[0]));
  add_normals(edges.size() - 1);
  for (const ExactPoint& edge : edges) {
    if (separated_side(edge, x) != 0) return edge;
  }
  for (const ExactPoint& normal : normals) {
    if (separated_side(normal, x) != 0) return normal;
    for (const ExactPoint& edge : edges) {
      const ExactPoint across = product(normal, edge);
      if (separated_side(across, x) != 0) return across;
    }
  }
  return {};
}

/// Whether a pair intersects at a time, and a direction that separates it where rounding could not
/// tell and exact integers had to.
struct Decision {
  bool intersects;
  std::optional<ExactPoint> direction;
};

Decision decide(const TrianglePairMotion& pair, std::int64_t time) {
  if (are_separated(pair, time, time)) return {false, {}};
  const Point3 sizes = sizes_of(pair);
  if (certainly_intersect(places_at(pair, time), std::max({sizes[0], sizes[1], sizes[2]}))) {
    return {true, {}};
  }
  std::optional<ExactPoint> direction = exact_direction(exact_places(pair, time));
  const bool intersects = !direction.has_value();
  return {intersects, std::move(direction)};
}

/// Whether a direction separates a pair, on one side, at both times and so between them.
bool separates_all(const ExactPoint& direction,
                   const TrianglePairMotion& pair,
                   std::int64_t from,
                   std::int64_t until) {
  const int side = separated_side(direction, exact_places(pair, from));
  return side != 0 && side == separated_side(direction, exact_places(pair, until));
}

/// Halves time from the first part on.
class TimeSearch {
 public:
  TimeSearch(const TrianglePairMotion& pair, std::int64_t most_intervals)
      : pair_(pair), most_intervals_(most_intervals) {}

  PairVerdict run() {
    if (do_intersect(pair_, 0)) return {Verdict::meets, 0, 0, 0};
    search(0, end_of_time, do_intersect(pair_, end_of_time));
    if (meeting_ >= 0)
      return {Verdict::meets, std::min(first_open_, meeting_), meeting_, intervals_};
    if (first_open_ <= last_open_) return {Verdict::undecided, first_open_, last_open_, intervals_};
    return {Verdict::free, 0, 0, intervals_};
  }

 private:
  /// Examines a part of time at whose beginning the triangles do not meet.
  /// @returns whether a meeting was found, after which the rest does not matter
  bool search(std::int64_t from, std::int64_t until, bool meets_at_end) {
    ++intervals_;
    if (!meets_at_end && are_separated(pair_, from, until)) return false;
    if (until - from > 1 && intervals_ < most_intervals_) {
      const std::int64_t middle = from + (until - from) / 2;
      const Decision decision = decide(pair_, middle);
      if (decision.direction && separates_all(*decision.direction, pair_, from, until))
        return false;
      if (search(from, middle, decision.intersects)) return true;
      return search(middle, until, meets_at_end);
    }
    first_open_ = std::min(first_open_, from);
    last_open_ = until;
    if (meets_at_end) meeting_ = until;
    return meets_at_end;
  }

  const TrianglePairMotion& pair_;
  std::int64_t most_intervals_, intervals_ = 0;
  std::int64_t meeting_ = -1;
  std::int64_t first_open_ = std::numeric_limits<std::int64_t>::max(), last_open_ = -1;
};
}  // namespace

bool are_separated(const TrianglePairMotion& pair, std::int64_t from, std::int64_t until) {
  const SixPoints begin = places_at(pair, from), end = places_at(pair, until);
  SixPoints middle;
  for (std::size_t p = 0; p < 6; ++p) middle[p] = times(0.5, plus(begin[p], end[p]));
  const Point3 sizes = sizes_of(pair);
  return any_direction(middle, [&](const Point3& direction) {
    // A place has three roundings, a product and the sum of three four more; their difference one.
    double error = underflow;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      error += 32 * unit_roundoff * std::abs(direction[axis]) * sizes[axis];
    }
    return gap_along(direction, begin) > error && gap_along(direction, end) > error;
  });
}

bool do_intersect(const TrianglePairMotion& pair, std::int64_t time) {
  return decide(pair, time).intersects;
}

PairVerdict judge(const TrianglePairMotion& pair, std::int64_t most_intervals) {
  return TimeSearch(pair, most_intervals).run();
}

}  // namespace tetwarp

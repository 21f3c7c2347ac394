#include "tests/oracles/interval_ccd.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <queue>
#include <vector>

namespace tetwarp::reference {
namespace {

/// Ranges of time and of the two coordinates.
struct Range {
  std::array<double, 3> low{0, 0, 0}, high{1, 1, 1};

  bool operator<(const Range& other) const { return low[0] > other.low[0]; }  // earliest on top
};

/// Weights of the four points in the difference of the two features' points.
using Weights = std::array<double, 4>;

Weights vertex_face_weights(double u, double v) {
  return {1, u + v - 1, -u, -v};
}
Weights edge_edge_weights(double u, double v) {
  return {1 - u, u, v - 1, -v};
}

class Bisection {
 public:
  Bisection(const PairMotion& pair, Weights (*weights)(double, double))
      : pair_(pair), weights_(weights) {
    double largest = 0;
    for (const auto* points : {&pair.start, &pair.end}) {
      for (const Point3& p : *points) {
        for (const double x : p) largest = std::max(largest, std::abs(x));
      }
    }
    inflation_ = 64 * (std::numeric_limits<double>::epsilon() / 2) * largest;
  }

  IntervalHit earliest(bool in_triangle, double tolerance, std::int64_t most_boxes) {
    IntervalHit hit;
    std::priority_queue<Range> open;
    open.push({});
    while (!open.empty()) {
      const Range range = open.top();
      open.pop();
      ++hit.boxes;
      const double width = width_of(range);
      if (width < 0) continue;
      const std::size_t axis = widest(range);
      const double middle = (range.low[axis] + range.high[axis]) / 2;
      const bool splits = middle > range.low[axis] && middle < range.high[axis];
      if (width <= tolerance || !splits || hit.boxes >= most_boxes) {
        hit.time = range.low[0];
        break;
      }
      Range lower = range, upper = range;
      lower.high[axis] = upper.low[axis] = middle;
      open.push(lower);
      if (!in_triangle || upper.low[1] + upper.low[2] <= 1) open.push(upper);
    }
    return hit;
  }

 private:
  /// Of the bound of the difference, along its longest axis; negative where it excludes 0.
  double width_of(const Range& range) const {
    double width = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (int corner = 0; corner < 8; ++corner) {
        const double t = corner & 1 ? range.high[0] : range.low[0];
        const double u = corner & 2 ? range.high[1] : range.low[1];
        const double v = corner & 4 ? range.high[2] : range.low[2];
        const Weights weight = weights_(u, v);
        double value = 0;
        for (std::size_t k = 0; k < 4; ++k) {
          value += weight[k] * ((1 - t) * pair_.start[k][i] + t * pair_.end[k][i]);
        }
        low = std::min(low, value), high = std::max(high, value);
      }
      if (low > inflation_ || high < -inflation_) return -1;
      width = std::max(width, high - low);
    }
    return width;
  }
  static std::size_t widest(const Range& range) {
    std::size_t axis = 0;
    for (std::size_t i = 1; i < 3; ++i) {
      if (range.high[i] - range.low[i] > range.high[axis] - range.low[axis]) axis = i;
    }
    return axis;
  }

  const PairMotion& pair_;
  Weights (*weights_)(double, double);
  double inflation_;
};

}  // namespace

IntervalHit interval_vertex_face(const PairMotion& pair,
                                 double tolerance,
                                 std::int64_t most_boxes) {
  return Bisection(pair, vertex_face_weights).earliest(true, tolerance, most_boxes);
}
IntervalHit interval_edge_edge(const PairMotion& pair, double tolerance, std::int64_t most_boxes) {
  return Bisection(pair, edge_edge_weights).earliest(false, tolerance, most_boxes);
}

}  // namespace tetwarp::reference

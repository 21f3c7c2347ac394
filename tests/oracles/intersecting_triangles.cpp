/// Pairs of triangles of given sets: those whose boxes overlap, found by sorting along x.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "tests/oracles/triangle_intersection.hpp"

namespace tetwarp::reference {
namespace {

struct Boxed {
  Triangle triangle;
  Point3 low, high;
  std::int32_t set, index;
};

void add_set(const TriangleSet& set, std::int32_t number, std::vector<Boxed>& boxed) {
  for (const Point3& p : set.points) {
    for (const double x : p) {
      if (!std::isfinite(x)) {
        throw std::invalid_argument("triangle sets: a coordinate is not finite");
      }
    }
  }
  for (std::size_t t = 0; t < set.triangles.size(); ++t) {
    Boxed item{{}, {}, {}, number, static_cast<std::int32_t>(t)};
    for (std::size_t c = 0; c < 3; ++c) {
      const std::int32_t v = set.triangles[t][c];
      if (v < 0 || static_cast<std::size_t>(v) >= set.points.size()) {
        throw std::invalid_argument("triangle sets: corner " + std::to_string(c) + " of triangle " +
                                    std::to_string(t) + " is no point of its set");
      }
      item.triangle[c] = set.points[static_cast<std::size_t>(v)];
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const Triangle& x = item.triangle;
      item.low[i] = std::min({x[0][i], x[1][i], x[2][i]});
      item.high[i] = std::max({x[0][i], x[1][i], x[2][i]});
    }
    boxed.push_back(item);
  }
}

/// Calls visit(a, b) for all pairs of overlapping boxes; a has the lower set, or index.
template <class Visit>
void visit_pairs(std::vector<Boxed> boxed, const Visit& visit) {
  std::sort(boxed.begin(), boxed.end(), [](const Boxed& a, const Boxed& b) {
    return a.low[0] != b.low[0] ? a.low[0] < b.low[0]
                                : std::pair(a.set, a.index) < std::pair(b.set, b.index);
  });
  for (std::size_t i = 0; i < boxed.size(); ++i) {
    for (std::size_t k = i + 1; k < boxed.size() && boxed[k].low[0] <= boxed[i].high[0]; ++k) {
      const Boxed *a = &boxed[i], *b = &boxed[k];
      if (a->low[1] > b->high[1] || b->low[1] > a->high[1]) continue;
      if (a->low[2] > b->high[2] || b->low[2] > a->high[2]) continue;
      if (std::pair(b->set, b->index) < std::pair(a->set, a->index)) std::swap(a, b);
      visit(*a, *b);
    }
  }
}

}  // namespace

std::vector<std::array<std::int32_t, 2>> intersecting_triangles(const TriangleSet& a,
                                                                const TriangleSet& b) {
  std::vector<Boxed> boxed;
  add_set(a, 0, boxed);
  add_set(b, 1, boxed);
  std::vector<std::array<std::int32_t, 2>> found;
  visit_pairs(std::move(boxed), [&](const Boxed& x, const Boxed& y) {
    if (x.set != y.set && triangles_intersect(x.triangle, y.triangle)) {
      found.push_back({x.index, y.index});
    }
  });
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<std::array<std::int32_t, 2>> self_intersections(const TriangleSet& set) {
  std::vector<Boxed> boxed;
  add_set(set, 0, boxed);
  const auto share_point = [&](std::int32_t i, std::int32_t k) {
    const auto& one = set.triangles[static_cast<std::size_t>(i)];
    const auto& other = set.triangles[static_cast<std::size_t>(k)];
    return std::any_of(one.begin(), one.end(), [&](std::int32_t v) {
      return std::find(other.begin(), other.end(), v) != other.end();
    });
  };
  std::vector<std::array<std::int32_t, 2>> found;
  visit_pairs(std::move(boxed), [&](const Boxed& x, const Boxed& y) {
    if (!share_point(x.index, y.index) && triangles_intersect(x.triangle, y.triangle)) {
      found.push_back({x.index, y.index});
    }
  });
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<std::array<std::int32_t, 2>> intersecting_sets(const std::vector<TriangleSet>& sets) {
  std::vector<Boxed> boxed;
  for (std::size_t s = 0; s < sets.size(); ++s) {
    add_set(sets[s], static_cast<std::int32_t>(s), boxed);
  }
  std::vector<std::array<std::int32_t, 2>> found;
  visit_pairs(std::move(boxed), [&](const Boxed& x, const Boxed& y) {
    if (x.set == y.set) return;
    const std::array<std::int32_t, 2> pair{x.set, y.set};
    const auto place = std::lower_bound(found.begin(), found.end(), pair);
    if (place != found.end() && *place == pair) return;
    if (triangles_intersect(x.triangle, y.triangle)) found.insert(place, pair);
  });
  return found;
}

}  // namespace tetwarp::reference

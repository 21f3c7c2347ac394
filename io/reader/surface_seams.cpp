/// @file surface_seams.cpp
/// Finds the points on open edges, and gives those at one place the first one's number.
#include "io/reader/surface_seams.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace tetwarp {

void join_seams(const std::vector<Point3>& points,
                std::vector<std::array<std::int32_t, 3>>& triangles) {
  const auto edge_of = [](const std::array<std::int32_t, 3>& triangle, std::size_t e) {
    return std::minmax(triangle[e], triangle[(e + 1) % 3]);
  };
  std::map<std::pair<std::int32_t, std::int32_t>, int> uses;
  for (const auto& triangle : triangles) {
    for (std::size_t e = 0; e < 3; ++e) ++uses[edge_of(triangle, e)];
  }
  std::vector<bool> is_open(points.size());
  for (const auto& [edge, count] : uses) {
    if (count != 1) continue;
    is_open[static_cast<std::size_t>(edge.first)] = true;
    is_open[static_cast<std::size_t>(edge.second)] = true;
  }
  std::map<Point3, std::int32_t> first;
  std::vector<std::int32_t> joined(points.size());
  for (std::size_t p = 0; p < points.size(); ++p) {
    joined[p] = static_cast<std::int32_t>(p);
    const Point3& x = points[p];
    const bool has_place = std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2]);
    if (is_open[p] && has_place) joined[p] = first.emplace(x, joined[p]).first->second;
  }
  for (auto& triangle : triangles) {
    for (std::int32_t& corner : triangle) corner = joined[static_cast<std::size_t>(corner)];
  }
}

}  // namespace tetwarp

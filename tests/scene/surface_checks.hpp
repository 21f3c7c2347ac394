/// @file surface_checks.hpp
/// Laws of triangle surfaces and tetrahedra of scenes.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <tetwarp/scene.hpp>
#include <utility>
#include <vector>

#include "host/base/point3.hpp"
#include "host/scene/shapes/lattice.hpp"

namespace tetwarp::scene_checks {

/// Every edge has two triangles, which pass it in opposite directions.
inline bool is_manifold(const Surface& surface) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> passes;
  for (const auto& triangle : surface.triangles) {
    for (std::size_t n = 0; n < 3; ++n) ++passes[{triangle[n], triangle[(n + 1) % 3]}];
  }
  return std::all_of(passes.begin(), passes.end(), [&](const auto& pass) {
    const auto back = passes.find({pass.first.second, pass.first.first});
    return pass.second == 1 && back != passes.end();
  });
}

/// Points - edges + triangles of a surface whose edges have two triangles each.
inline std::int64_t euler_number(const Surface& surface) {
  return static_cast<std::int64_t>(surface.points.size()) -
         static_cast<std::int64_t>(surface.triangles.size()) / 2;
}

inline std::vector<double> volumes_of(const std::vector<Point3>& nodes,
                                      const std::vector<std::array<std::int32_t, 4>>& tets) {
  std::vector<double> volumes;
  volumes.reserve(tets.size());
  for (const auto& [a, b, c, d] : tets) {
    volumes.push_back(tet_volume(at(nodes, a), at(nodes, b), at(nodes, c), at(nodes, d)));
  }
  return volumes;
}

inline double sum_of(const std::vector<double>& numbers) {
  double sum = 0;
  for (const double number : numbers) sum += number;
  return sum;
}

/// Whether each node has a tetrahedron.
inline bool uses_all_nodes(std::size_t node_count,
                           const std::vector<std::array<std::int32_t, 4>>& tets) {
  std::vector<bool> is_used(node_count);
  for (const auto& tet : tets) {
    for (const std::int32_t node : tet) is_used.at(static_cast<std::size_t>(node)) = true;
  }
  return std::count(is_used.begin(), is_used.end(), true) ==
         static_cast<std::ptrdiff_t>(node_count);
}

}  // namespace tetwarp::scene_checks

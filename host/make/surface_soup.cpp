/// @file surface_soup.cpp
/// Collects the triangles and computes their normals.
#include "host/make/surface_soup.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "host/base/point3.hpp"

namespace tetwarp {
namespace {
const double crease_cosine = std::cos(40 * 3.14159265358979 / 180);

void check_surface(const DrawnSurface& surface, std::size_t index) {
  const std::string name = "render_surfaces: surface " + std::to_string(index);
  for (const Point3& point : surface.points) {
    for (const double coordinate : point) {
      if (!std::isfinite(coordinate)) throw std::invalid_argument(name + ": a point is not finite");
    }
  }
  for (const auto& triangle : surface.triangles) {
    for (const std::int32_t point : triangle) {
      if (point < 0 || static_cast<std::size_t>(point) >= surface.points.size()) {
        throw std::invalid_argument(name + ": a triangle has point " + std::to_string(point) +
                                    " of " + std::to_string(surface.points.size()));
      }
    }
  }
}

/// Triangles around each point: first entry of each point, then the entries.
struct PointTriangles {
  std::vector<std::size_t> first;
  std::vector<std::int32_t> triangle;
};

PointTriangles triangles_of_points(const SurfaceSoup& soup) {
  PointTriangles around;
  around.first.assign(soup.points.size() + 1, 0);
  for (const auto& triangle : soup.triangles) {
    for (const std::int32_t point : triangle) ++around.first[static_cast<std::size_t>(point) + 1];
  }
  for (std::size_t p = 0; p < soup.points.size(); ++p) around.first[p + 1] += around.first[p];
  around.triangle.resize(3 * soup.triangles.size());
  std::vector<std::size_t> next(around.first.begin(), around.first.end() - 1);
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    for (const std::int32_t point : soup.triangles[t]) {
      around.triangle[next[static_cast<std::size_t>(point)]++] = static_cast<std::int32_t>(t);
    }
  }
  return around;
}

void set_normals(SurfaceSoup& soup) {
  std::vector<Point3> areas;  // normals of triangles, twice their area long
  areas.reserve(soup.triangles.size());
  for (const auto& triangle : soup.triangles) {
    const Point3& a = soup.points[static_cast<std::size_t>(triangle[0])];
    const Point3& b = soup.points[static_cast<std::size_t>(triangle[1])];
    const Point3& c = soup.points[static_cast<std::size_t>(triangle[2])];
    areas.push_back(cross(minus(b, a), minus(c, a)));
  }
  const PointTriangles around = triangles_of_points(soup);
  soup.normals.resize(soup.triangles.size());
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    const Point3 own = unit(areas[t]);
    for (std::size_t c = 0; c < 3; ++c) {
      const auto point = static_cast<std::size_t>(soup.triangles[t][c]);
      Point3 sum{0, 0, 0};
      for (std::size_t n = around.first[point]; n < around.first[point + 1]; ++n) {
        const Point3& area = areas[static_cast<std::size_t>(around.triangle[n])];
        if (dot(area, own) > crease_cosine * norm(area)) sum = plus(sum, area);
      }
      soup.normals[t][c] = norm(sum) > 0 ? unit(sum) : own;
    }
  }
}
}  // namespace

SurfaceSoup make_soup(std::span<const DrawnSurface> surfaces) {
  SurfaceSoup soup;
  std::size_t points = 0, triangles = 0;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    check_surface(surfaces[s], s);
    points += surfaces[s].points.size();
    triangles += surfaces[s].triangles.size();
  }
  if (points > std::numeric_limits<std::int32_t>::max() ||
      triangles > std::numeric_limits<std::int32_t>::max()) {
    throw std::invalid_argument("render_surfaces: more than 2^31 points or triangles");
  }
  soup.points.reserve(points);
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    const auto first = static_cast<std::int32_t>(soup.points.size());
    soup.points.insert(soup.points.end(), surfaces[s].points.begin(), surfaces[s].points.end());
    for (const auto& triangle : surfaces[s].triangles) {
      soup.triangles.push_back({triangle[0] + first, triangle[1] + first, triangle[2] + first});
      soup.surface.push_back(static_cast<std::int32_t>(s));
    }
  }
  if (!soup.points.empty()) soup.low = soup.high = soup.points.front();
  for (const Point3& point : soup.points) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      soup.low[axis] = std::min(soup.low[axis], point[axis]);
      soup.high[axis] = std::max(soup.high[axis], point[axis]);
    }
  }
  set_normals(soup);
  return soup;
}

}  // namespace tetwarp

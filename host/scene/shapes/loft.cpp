/// @file loft.cpp
/// Surfaces and tetrahedra of lofts.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tetwarp/loft.hpp>

#include "host/scene/checks/check_geometry.hpp"
#include "host/scene/checks/scene_checks.hpp"
#include "host/scene/shapes/lattice.hpp"
#include "host/scene/shapes/loft_line.hpp"
#include "host/scene/shapes/rings.hpp"
#include "host/scene/shapes/shape_lattice.hpp"
#include "host/scene/shapes/surface_pattern.hpp"

namespace tetwarp {
namespace {
using std::numbers::pi;

/// By how much tetrahedra reach beyond the tube where they are straight along it.
constexpr double margin = 1.03;
constexpr double most_triangles = 1e7;

/// Of the ellipses of the stations, about [m].
double mean_perimeter(const LoftTube& tube) {
  double sum = 0;
  for (const auto& [center, radii, direction] : tube.stations) sum += pi * (radii[0] + radii[1]);
  return sum / static_cast<double>(tube.stations.size());
}

/// Places of rings about `spacing` apart, stations among them.
std::vector<double> ring_places(const LoftLine& line, const LoftTube& tube, double spacing) {
  const auto rings_of_end = [&](const LoftStation& station, double end) {
    const double radius = 0.5 * (station.radii[0] + station.radii[1]);
    return std::max(2, count_along(pi / 4 * (radius + end), spacing));
  };
  std::vector<double> places;
  const int first = rings_of_end(tube.stations.front(), tube.ends[0]);
  for (int r = 1; r < first; ++r) places.push_back(-tube.ends[0] * std::cos(pi / 2 * r / first));
  const std::vector<double>& at = line.places();
  for (std::size_t n = 0; n + 1 < at.size(); ++n) {
    const int along = count_along(at[n + 1] - at[n], spacing);
    for (int r = 0; r < along; ++r) places.push_back(at[n] + (at[n + 1] - at[n]) * r / along);
  }
  const int last = rings_of_end(tube.stations.back(), tube.ends[1]);
  for (int r = 0; r < last; ++r) {
    places.push_back(at.back() + tube.ends[1] * std::sin(pi / 2 * r / last));
  }
  return places;
}

Surface tube_surface(const LoftTube& tube, std::int64_t triangles) {
  const LoftLine line(tube);
  const double perimeter = mean_perimeter(tube);
  const int around = nearest_pattern(3, triangles, [&](int n) {
    return 2.0 * n * static_cast<double>(ring_places(line, tube, perimeter / n).size());
  });
  Rings rings;
  rings.around = around;
  for (const double place : ring_places(line, tube, perimeter / around)) {
    rings.ring.push_back([section = line.section(place)](double angle) {
      return section.point(std::cos(angle), std::sin(angle));
    });
  }
  rings.first_pole = line.section(-tube.ends[0]).center;
  rings.last_pole = line.section(line.places().back() + tube.ends[1]).center;
  return ring_surface(rings);
}

/// A box as long and, in the mean, as wide as the tube, centered on its axis x.
Bounds straight_box(const LoftLine& line, const LoftTube& tube) {
  std::array<double, 2> radius{0, 0};
  constexpr int samples = 64;
  const double last = line.places().back();
  for (int n = 0; n <= samples; ++n) {
    const LoftSection section = line.section(last * n / samples);
    for (std::size_t r = 0; r < 2; ++r) radius[r] += section.radii[r] / (samples + 1);
  }
  return {{-tube.ends[0], -radius[0], -radius[1]}, {last + tube.ends[1], radius[0], radius[1]}};
}

/// The square [-1, 1]^2 as a disc.
std::array<double, 2> on_disc(double p, double q) {
  return {p * std::sqrt(1 - q * q / 2), q * std::sqrt(1 - p * p / 2)};
}

/// Of the outline of squares as a disc the distance of its nearest edge from the middle.
double inner_radius(const std::array<double, 2>& squares) {
  double least = 1;
  for (const bool is_second : {false, true}) {
    const double step = 2 / squares[is_second ? 1 : 0];
    for (double p = -1; p < 1 - step / 2; p += step) {
      const auto [ax, ay] = on_disc(p, 1);
      const auto [bx, by] = on_disc(p + step, 1);
      least = std::min(least, std::abs(ax * by - ay * bx) / std::hypot(bx - ax, by - ay));
    }
  }
  return least;
}
}  // namespace

double loft_volume(const LoftTube& tube) {
  return LoftLine(tube).volume();
}

Surface make_loft_surface(const std::vector<LoftTube>& tubes, std::int64_t triangles) {
  if (tubes.empty()) fail_at("tubes", "expected one or more");
  check_range("triangles", static_cast<double>(triangles), 4, most_triangles);
  std::vector<double> area;
  double total = 0;
  for (const LoftTube& tube : tubes) {
    area.push_back(mean_perimeter(tube) *
                   (LoftLine(tube).places().back() + tube.ends[0] + tube.ends[1]));
    total += area.back();
  }
  Surface surface;
  for (std::size_t t = 0; t < tubes.size(); ++t) {
    const Surface one =
        tube_surface(tubes[t], std::llround(static_cast<double>(triangles) * area[t] / total));
    const auto first = static_cast<std::int32_t>(surface.points.size());
    surface.points.insert(surface.points.end(), one.points.begin(), one.points.end());
    for (const auto& [a, b, c] : one.triangles) {
      surface.triangles.push_back({first + a, first + b, first + c});
    }
  }
  return surface;
}

Mesh make_loft_mesh(const LoftTube& tube, const Lattice& lattice) {
  const LoftLine line(tube);
  check_lattice("lattice", lattice);
  const Bounds box = straight_box(line, tube);
  ShapeLattice cells = make_filling_lattice("lattice", box, lattice);
  const double factor = margin / inner_radius({cells.cells_across[1], cells.cells_across[2]});
  Mesh mesh{{}, std::move(cells.mesh.tets)};
  for (const Point3& node : cells.mesh.nodes) {
    const auto [x, y] = on_disc(node[1] / box.high[1], node[2] / box.high[2]);
    mesh.rest_positions.push_back(line.wide_section(node[0]).point(factor * x, factor * y));
  }
  for (const auto& [a, b, c, d] : mesh.tets) {
    const std::vector<Point3>& x = mesh.rest_positions;
    if (tet_volume(at(x, a), at(x, b), at(x, c), at(x, d)) > 0) continue;
    fail_at("lattice",
            "its cells fold where the tube bends; use smaller radii, or fewer cells "
            "across");
  }
  return mesh;
}

}  // namespace tetwarp

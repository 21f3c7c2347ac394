/// @file shape_lattice.cpp
/// Fills or covers a shape with cells, and corrects the total volume.
#include "host/scene/shapes/shape_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

#include "host/scene/shapes/lattice_search.hpp"
#include "host/scene/shapes/shape.hpp"
#include "host/scene/shapes/shape_fraction.hpp"

namespace tetwarp {
namespace {
/// Tetrahedra with a smaller part inside are dropped.
constexpr double smallest_fraction = 1e-3;
/// Resolution of fractions in feature lengths: for the choice of tetrahedra, and for their volume.
constexpr double choice_resolution = 0.5;
constexpr double volume_resolution = 0.25;

/// Numbers of cells that fill a box with about `wanted` tetrahedra, cells nearly cubes: of those
/// within rounding of cubes, a difference of a tenth of the tetrahedra weighs as much as edges that
/// differ by a half.
std::array<std::int64_t, 3> cells_near(const Point3& length, std::int64_t wanted) {
  const double ideal =
      std::cbrt(5 * length[0] * length[1] * length[2] / static_cast<double>(wanted));
  std::array<std::int64_t, 3> best{1, 1, 1};
  double best_cost = std::numeric_limits<double>::infinity();
  for (int step = -40; step <= 40; ++step) {
    const double edge = ideal * std::exp2(0.025 * step);
    for (int choice = 0; choice < 8; ++choice) {
      std::array<std::int64_t, 3> cells{};
      double count = 5, longest = 0, shortest = std::numeric_limits<double>::infinity();
      for (std::size_t d = 0; d < 3; ++d) {
        const double whole = std::max(1.0, std::floor(length[d] / edge) + (choice >> d & 1));
        cells[d] = static_cast<std::int64_t>(whole);
        count *= whole;
        longest = std::max(longest, length[d] / whole);
        shortest = std::min(shortest, length[d] / whole);
      }
      const double cost =
          std::abs(count / static_cast<double>(wanted) - 1) + 0.2 * (longest / shortest - 1);
      if (cost < best_cost) {
        best_cost = cost;
        best = cells;
      }
    }
  }
  return best;
}
}  // namespace

void scale_to_total(const TetMesh& mesh,
                    double total,
                    const std::array<double, 2>& between,
                    std::vector<double>& fraction) {
  const auto is_scaled = [&](double share) { return share > between[0] && share < between[1]; };
  // Fractions that reach 1 leave a rest to the others.
  for (int pass = 0; pass < 10; ++pass) {
    double kept = 0, scaled = 0;
    for (std::size_t t = 0; t < fraction.size(); ++t) {
      (is_scaled(fraction[t]) ? scaled : kept) += fraction[t] * tet_volume(mesh, mesh.tets[t]);
    }
    if (scaled == 0) return;
    const double factor = (total - kept) / scaled;
    if (std::abs(factor - 1) < 1e-15) return;
    for (double& share : fraction) {
      if (is_scaled(share)) share = std::min(1.0, factor * share);
    }
  }
}

ShapeLattice make_filling_lattice(const std::string& place,
                                  const Bounds& bounds,
                                  const Lattice& choice) {
  const Point3 length = minus(bounds.high, bounds.low);
  const auto frame_of_edge = [&](double edge, double) {
    std::array<std::int64_t, 3> cells{};
    for (std::size_t d = 0; d < 3; ++d) {
      cells[d] = std::max<std::int64_t>(1, std::llround(length[d] / edge));
    }
    return fitted_frame(bounds, cells);
  };
  const Lattice exact = choice.tets ? Lattice{.cells = cells_near(length, *choice.tets)} : choice;
  ChosenLattice chosen = choose_lattice(
      place, exact, bounds, length, length[0] * length[1] * length[2], frame_of_edge, make_lattice);
  ShapeLattice lattice{std::move(chosen.mesh), {}, {}};
  for (std::size_t d = 0; d < 3; ++d) {
    lattice.cells_across[d] = static_cast<double>(chosen.frame.cells[d]);
  }
  return lattice;
}

ShapeLattice make_shape_lattice(const std::string& place,
                                const Shape& shape,
                                const Lattice& choice) {
  if (std::holds_alternative<BoxShape>(shape) || std::holds_alternative<PlateShape>(shape)) {
    return make_filling_lattice(place, bounds_of(shape), choice);
  }
  if (const auto* strip = std::get_if<BentStripShape>(&shape)) {
    ShapeLattice lattice = make_filling_lattice(place, straight_bounds(*strip), choice);
    map_nodes(lattice.mesh, [&](const Point3& x) {
      return Point3{x[0], x[1], x[2] + rise_of(*strip, x[0])};
    });
    return lattice;
  }
  const Bounds bounds = bounds_of(shape);
  const Point3 length = minus(bounds.high, bounds.low);
  const auto frame_of_edge = [&](double edge, double offset) {
    return covering_frame(bounds, {edge, edge, edge}, offset);
  };
  const auto mesh_of = [&](const LatticeFrame& frame) {
    TetMesh mesh = make_lattice(frame);
    std::vector<std::uint8_t> is_kept;
    for (const double fraction :
         fractions_inside(shape, mesh, choice_resolution * feature_length(shape))) {
      is_kept.push_back(fraction >= smallest_fraction);
    }
    keep_tets(mesh, is_kept);
    return mesh;
  };
  ChosenLattice chosen =
      choose_lattice(place, choice, bounds, length, volume_of(shape), frame_of_edge, mesh_of);
  ShapeLattice lattice{std::move(chosen.mesh), {}, {}};
  lattice.fraction =
      fractions_inside(shape, lattice.mesh, volume_resolution * feature_length(shape));
  scale_to_total(lattice.mesh, volume_of(shape), {0, 1}, lattice.fraction);
  for (std::size_t d = 0; d < 3; ++d) lattice.cells_across[d] = length[d] / chosen.frame.edge[d];
  return lattice;
}

}  // namespace tetwarp

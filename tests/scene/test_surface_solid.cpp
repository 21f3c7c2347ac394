/// @file test_surface_solid.cpp
/// Parts of tetrahedra within closed surfaces.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <tetwarp/tetwarp.hpp>
#include <vector>

#include "host/scene/shapes/shape_surface.hpp"
#include "host/scene/shapes/surface.hpp"
#include "host/scene/shapes/surface_lattice.hpp"
#include "host/scene/shapes/surface_solid.hpp"
#include "tests/scene/shape_samples.hpp"
#include "tests/scene/surface_checks.hpp"

namespace tetwarp {
namespace {
using scene_checks::named_shapes;
using scene_checks::volumes_of;

struct CutLattice {
  TetMesh mesh;
  std::vector<std::uint8_t> is_cut;
  std::vector<double> fractions;
};

CutLattice cut_lattice(const Surface& surface, int cells) {
  Bounds bounds;
  for (const Point3& x : surface.points) bounds.include(x);
  const double edge = norm(minus(bounds.high, bounds.low)) / cells;
  CutLattice lattice;
  lattice.mesh =
      tets_around(covering_frame(bounds, {edge, edge, edge}, 0.3), surface, &lattice.is_cut);
  lattice.fractions = fractions_within(surface, lattice.mesh, lattice.is_cut);
  return lattice;
}

double filled(const TetMesh& mesh, const std::vector<double>& fractions) {
  double sum = 0;
  const std::vector<double> volumes = volumes_of(mesh.nodes, mesh.tets);
  for (std::size_t t = 0; t < volumes.size(); ++t) sum += fractions[t] * volumes[t];
  return sum;
}

TEST(SurfaceSolid, PartsAddUpToWhatASurfaceEncloses) {
  for (const auto& [name, shape] : named_shapes()) {
    const Surface surface = make_shape_surface(shape, 400);
    for (const int cells : {1, 3, 9}) {
      const CutLattice lattice = cut_lattice(surface, cells);
      EXPECT_NEAR(filled(lattice.mesh, lattice.fractions) / volume_of(surface), 1, 1e-11)
          << name << ' ' << cells;
    }
  }
}

/// Against points of each tetrahedron and the numbers of turns around them.
TEST(SurfaceSolid, EveryPartIsWhatLiesInside) {
  std::mt19937 random(5);
  std::exponential_distribution<double> part(1);
  for (const auto& [name, shape] : named_shapes()) {
    const Surface surface = make_shape_surface(shape, 120);
    const CutLattice lattice = cut_lattice(surface, 4);
    constexpr int count = 300;
    for (std::size_t t = 0; t < lattice.mesh.tets.size(); t += 7) {
      int inside = 0;
      for (int n = 0; n < count; ++n) {
        Point3 x{0, 0, 0};
        double sum = 0;
        for (const std::int32_t node : lattice.mesh.tets[t]) {
          const double weight = part(random);
          sum += weight;
          x = plus(x, times(weight, lattice.mesh.nodes[static_cast<std::size_t>(node)]));
        }
        inside += winding_number(surface, times(1 / sum, x)) > 0.5;
      }
      const double expected = lattice.fractions[t];
      const double deviation = std::sqrt(expected * (1 - expected) / count);
      EXPECT_NEAR(static_cast<double>(inside) / count, expected, 4.5 * deviation + 3.0 / count)
          << name;
    }
  }
}

/// Columns along z are no different from columns along x.
TEST(SurfaceSolid, DoesNotDependOnTheDirectionOfColumns) {
  for (const auto& [name, shape] : named_shapes()) {
    const Surface surface = make_shape_surface(shape, 200);
    const CutLattice lattice = cut_lattice(surface, 5);
    const auto turned = [](const Point3& x) { return Point3{x[1], x[2], x[0]}; };
    Surface other = surface;
    TetMesh mesh = lattice.mesh;
    std::ranges::transform(other.points, other.points.begin(), turned);
    std::ranges::transform(mesh.nodes, mesh.nodes.begin(), turned);

    const std::vector<double> fractions = fractions_within(other, mesh, lattice.is_cut);

    for (std::size_t t = 0; t < fractions.size(); ++t) {
      ASSERT_NEAR(fractions[t], lattice.fractions[t], 1e-10) << name;
    }
  }
}

TEST(SurfaceSolid, LatticesHoldEveryPointAndTheWholeVolume) {
  const std::array<Lattice, 3> choices{Lattice{.cells = {{3, 4, 5}}}, Lattice{.edge = 0.31},
                                       Lattice{.tets = 200}};
  for (const auto& [name, shape] : named_shapes()) {
    const Surface surface = make_shape_surface(shape, 400);
    for (const Lattice& choice : choices) {
      const ShapeLattice lattice = make_solid_lattice("lattice", surface, choice);
      const BoundPoints bound =
          bind_points({lattice.mesh.nodes, lattice.mesh.tets, {}}, surface.points);

      EXPECT_NEAR(filled(lattice.mesh, lattice.fraction) / volume_of(surface), 1, 1e-11) << name;
      EXPECT_LT(bound.largest_distance, 1e-12) << name;
      EXPECT_GT(*std::ranges::min_element(lattice.fraction), 0) << name;
      EXPECT_LE(*std::ranges::max_element(lattice.fraction), 1 + 1e-12) << name;
      if (choice.tets) {
        EXPECT_NEAR(static_cast<double>(lattice.mesh.tets.size()), 200, 60) << name;
      }
    }
  }
}

/// Parts below a hundredth of the mean one are raised to it; all others are scaled by one factor.
TEST(SurfaceSolid, LatticesScaleLargeFractionsByOneFactorNearOne) {
  for (const auto& [name, shape] : named_shapes()) {
    const Surface surface = make_shape_surface(shape, 400);
    for (const std::int64_t cells : {1, 2, 5}) {
      const ShapeLattice lattice =
          make_solid_lattice("lattice", surface, {.cells = {{cells, cells, cells}}});
      const std::vector<double> within = fractions_within(
          surface, lattice.mesh, std::vector<std::uint8_t>(lattice.mesh.tets.size(), 1));
      const std::vector<double> whole(within.size(), 1);
      const double least = 0.01 * volume_of(surface) / filled(lattice.mesh, whole);
      double low = 2, high = 0;
      for (std::size_t t = 0; t < within.size(); ++t) {
        if (within[t] <= least) {
          ASSERT_NEAR(lattice.fraction[t], least, 1e-12) << name << ' ' << cells;
        } else {
          low = std::min(low, lattice.fraction[t] / within[t]);
          high = std::max(high, lattice.fraction[t] / within[t]);
        }
      }
      EXPECT_GE(low, 0.99 - 1e-9) << name << ' ' << cells;
      EXPECT_LE(high, 1 + 1e-9) << name << ' ' << cells;
      EXPECT_LT(high - low, 1e-7) << name << ' ' << cells;
    }
  }
}

}  // namespace
}  // namespace tetwarp

/// @file test_shape_lattice.cpp
/// Lattices of shapes: volumes, counts, nodes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "host/scene/shapes/shape.hpp"
#include "host/scene/shapes/shape_fraction.hpp"
#include "host/scene/shapes/shape_lattice.hpp"
#include "host/scene/shapes/surface.hpp"
#include "tests/scene/shape_samples.hpp"
#include "tests/scene/surface_checks.hpp"
#include "tests/support/message_of.hpp"

namespace tetwarp {
namespace {
using scene_checks::named_shapes;
using scene_checks::sum_of;
using scene_checks::uses_all_nodes;
using scene_checks::volumes_of;

double volume_of(const ShapeLattice& lattice) {
  const std::vector<double> volumes = volumes_of(lattice.mesh.nodes, lattice.mesh.tets);
  double sum = 0;
  for (std::size_t t = 0; t < volumes.size(); ++t) {
    sum += volumes[t] * (lattice.fraction.empty() ? 1 : lattice.fraction[t]);
  }
  return sum;
}

TEST(ShapeLattice, FillsBoxesPlatesAndBentStripsExactly) {
  for (const auto& [name, shape] : named_shapes()) {
    if (name != "box" && name != "plate" && name != "bent strip") continue;

    const ShapeLattice lattice =
        make_shape_lattice("lattice", shape, {.cells = std::array<std::int64_t, 3>{12, 3, 4}});

    EXPECT_EQ(lattice.mesh.tets.size(), 720u) << name;
    EXPECT_EQ(lattice.mesh.nodes.size(), 13u * 4 * 5) << name;
    EXPECT_TRUE(lattice.fraction.empty()) << name;
    EXPECT_NEAR(volume_of(lattice) / volume_of(shape), 1, 1e-12) << name;
  }
}

TEST(ShapeLattice, HasTheVolumeOfTheShape) {
  for (const auto& [name, shape] : named_shapes()) {
    for (const std::int64_t tets : {20, 200}) {
      const ShapeLattice lattice = make_shape_lattice("lattice", shape, {.tets = tets});

      EXPECT_NEAR(volume_of(lattice) / volume_of(shape), 1, 1e-12) << name << " " << tets;
      const auto volumes = volumes_of(lattice.mesh.nodes, lattice.mesh.tets);
      EXPECT_GT(*std::min_element(volumes.begin(), volumes.end()), 0) << name;
      EXPECT_TRUE(uses_all_nodes(lattice.mesh.nodes.size(), lattice.mesh.tets)) << name;
      for (const double fraction : lattice.fraction) {
        ASSERT_GT(fraction, 0) << name;
        ASSERT_LE(fraction, 1) << name;
      }
    }
  }
}

/// Before the correction of their sum the fractions add up to the volume within 1e-3.
TEST(ShapeLattice, HasFractionsThatAddUpByThemselves) {
  for (const auto& [name, shape] : named_shapes()) {
    const double edge = feature_length(shape);
    const Bounds bounds = bounds_of(shape);
    const TetMesh mesh = make_lattice(covering_frame(bounds, {edge, edge, edge}, 0));
    const std::vector<double> volumes = volumes_of(mesh.nodes, mesh.tets);
    const std::vector<double> fraction = fractions_inside(shape, mesh, 0.1 * edge);
    double sum = 0;

    for (std::size_t t = 0; t < volumes.size(); ++t) sum += volumes[t] * fraction[t];

    EXPECT_NEAR(sum / volume_of(shape), 1, 1e-3) << name;
  }
}

TEST(ShapeLattice, HasAboutTheNumberOfTetrahedraAsked) {
  for (const auto& [name, shape] : named_shapes()) {
    for (const double tets : {154.0, 475.0}) {
      const ShapeLattice lattice =
          make_shape_lattice("lattice", shape, {.tets = static_cast<std::int64_t>(tets)});

      EXPECT_NEAR(static_cast<double>(lattice.mesh.tets.size()) / tets, 1, 0.06) << name;
    }
  }
}

TEST(ShapeLattice, CoversBoundsWithCubesOfAnEdge) {
  const Shape sphere = EllipsoidShape{{0.5, 0.5, 0.5}};

  const ShapeLattice lattice = make_shape_lattice("lattice", sphere, {.edge = 0.5});

  EXPECT_EQ(lattice.mesh.tets.size(), 40u);
  EXPECT_EQ(lattice.mesh.nodes.size(), 27u);
  EXPECT_EQ(lattice.cells_across, (Point3{2, 2, 2}));
}

TEST(ShapeLattice, TooManyTetrahedraAreAnError) {
  const Shape sphere = EllipsoidShape{{0.5, 0.5, 0.5}};

  const std::string message =
      test::message_of([&] { make_shape_lattice("bodies[0].lattice", sphere, {.edge = 1e-4}); });

  EXPECT_EQ(message, "bodies[0].lattice.edge: makes 2^31 or more tetrahedra; use larger cells");
}
}  // namespace
}  // namespace tetwarp

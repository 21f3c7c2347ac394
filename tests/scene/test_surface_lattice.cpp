/// @file test_surface_lattice.cpp
/// Lattices in closed surfaces: they cover what the surface encloses and nothing far from it;
/// points bound to tetrahedra.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <tetwarp/tetwarp.hpp>
#include <vector>

#include "host/scene/shapes/shape.hpp"
#include "host/scene/shapes/shape_surface.hpp"
#include "host/scene/shapes/surface_lattice.hpp"
#include "tests/scene/image_samples.hpp"
#include "tests/scene/shape_samples.hpp"
#include "tests/scene/surface_checks.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/torn_mesh.hpp"

namespace tetwarp {
namespace {
using scene_checks::named_shapes;
using scene_checks::sum_of;
using scene_checks::volumes_of;

constexpr std::array<Point3, 4> unit_tet{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

TEST(SurfaceLattice, TouchesTrianglesThatMeetATetrahedron) {
  EXPECT_TRUE(may_touch(unit_tet, {{{0.1, 0.1, 0.1}, {0.2, 0.1, 0.1}, {0.1, 0.2, 0.1}}}));
  EXPECT_TRUE(may_touch(unit_tet, {{{-9, 0.1, -9}, {9, 0.1, -9}, {0, 0.1, 20}}}));
  EXPECT_TRUE(may_touch(unit_tet, {{{1, 0, 0}, {2, 0, 0}, {2, 1, 0}}}));
  EXPECT_FALSE(may_touch(unit_tet, {{{0.4, 0.4, 0.4}, {2, 0.4, 0.4}, {0.4, 2, 0.4}}}));
  EXPECT_FALSE(may_touch(unit_tet, {{{-1, -1, -1e-6}, {2, -1, -1e-6}, {-1, 2, -1e-6}}}));
  // Apart by no plane of a face: an edge passes an edge.
  EXPECT_FALSE(may_touch(unit_tet, {{{-0.2, -0.2, 0.4}, {0.3, -0.3, 0.9}, {-0.2, -2, 0.7}}}));
}

TEST(SurfaceLattice, WindsOnceAroundPointsInside) {
  for (const auto& [name, shape] : named_shapes()) {
    const Surface surface = make_shape_surface(shape, 400);
    const Point3 inside =
        name.find("arc") == std::string::npos && name != "torus" && name != "bent strip"
            ? Point3{0, 0, 0}
            : surface.points[0];
    if (inside == Point3{0, 0, 0}) {
      EXPECT_NEAR(winding_number(surface, inside), 1, 1e-12) << name;
    }
    EXPECT_NEAR(winding_number(surface, {5, 4, 3}), 0, 1e-12) << name;
  }
}

TEST(SurfaceLattice, CoversWhatTheSurfaceEncloses) {
  for (const auto& [name, shape] : named_shapes()) {
    const Surface surface = make_shape_surface(shape, 400);
    for (const std::int64_t cells : {1, 7, 16}) {
      const Mesh mesh = make_lattice_mesh(surface, cells);

      const BoundPoints bound = bind_points(mesh, surface.points);
      EXPECT_LT(bound.largest_distance, 1e-12) << name;
      const auto volumes = volumes_of(mesh.rest_positions, mesh.tets);
      EXPECT_GT(*std::min_element(volumes.begin(), volumes.end()), 0) << name;
      EXPECT_GE(sum_of(volumes), volume_of(shape) * 0.85) << name;
      if (cells == 16 && name == "sphere") {
        EXPECT_LT(sum_of(volumes), 1.6 * volume_of(shape));
      }
    }
  }
}

TEST(SurfaceLattice, LeavesTheHoleOfATorusOpen) {
  const Surface torus = make_shape_surface(TorusShape{1, 0.2}, 2000);

  const Mesh mesh = make_lattice_mesh(torus, 24);

  EXPECT_GT(bind_points(mesh, {{0, 0, 0}}).largest_distance, 0.6);
  EXPECT_LT(bind_points(mesh, {{1, 0, 0}, {0, -1, 0}}).largest_distance, 1e-12);
}

TEST(SurfaceLattice, BindsPointsToTheirPlaces) {
  const Mesh mesh = make_lattice_mesh(make_shape_surface(TorusShape{1, 0.3}, 500), 9);
  const Surface surface = boundary_surface(mesh);

  const BoundPoints bound = bind_points(mesh, surface.points);

  for (std::size_t p = 0; p < surface.points.size(); ++p) {
    Point3 x{0, 0, 0};
    for (std::size_t n = 0; n < 4; ++n) {
      x = plus(x, times(bound.weights[p][n], at(mesh.rest_positions, bound.nodes[p][n])));
    }
    ASSERT_LT(norm(minus(x, surface.points[p])), 1e-12);
  }
}

/// Nodes at one place are told apart: each point of the boundary is bound to a node of its own.
TEST(SurfaceLattice, BindsTheBoundaryToItsNodes) {
  const Mesh whole = make_lattice_mesh(make_shape_surface(BoxShape{{1, 1, 1}}, 12), 2);
  for (const std::uint32_t seed : {1, 2, 3}) {
    const Mesh mesh = test::torn(whole, seed);
    const Surface surface = boundary_surface(mesh);

    const BoundPoints bound = bind_boundary(mesh);

    ASSERT_EQ(bound.nodes.size(), surface.points.size());
    std::vector<std::int32_t> nodes;
    for (std::size_t p = 0; p < surface.points.size(); ++p) {
      const auto one = std::find(bound.weights[p].begin(), bound.weights[p].end(), 1);
      ASSERT_EQ(std::count(bound.weights[p].begin(), bound.weights[p].end(), 0), 3);
      nodes.push_back(bound.nodes[p][static_cast<std::size_t>(one - bound.weights[p].begin())]);
      EXPECT_EQ(at(mesh.rest_positions, nodes.back()), surface.points[p]);
    }
    EXPECT_TRUE(std::is_sorted(nodes.begin(), nodes.end()));
    EXPECT_EQ(std::adjacent_find(nodes.begin(), nodes.end()), nodes.end());
  }
}

TEST(SurfaceLattice, IsosurfacesOfVolumesAreInTheirLattices) {
  const ImageGeometry image = scene_checks::ball_image({20, 20, 20}, 7);

  const Surface surface = make_isosurface(image.volume, 0, 500);

  EXPECT_LT(bind_points(make_lattice_mesh(surface, 6), surface.points).largest_distance, 1e-12);
  EXPECT_NE(test::message_of([&] { make_isosurface(image.volume, 0, 2); }).find("triangles"),
            std::string::npos);
}

TEST(SurfaceLattice, OpenSurfacesAreErrors) {
  Surface surface = make_shape_surface(BoxShape{{1, 1, 1}}, 12);
  surface.triangles.pop_back();

  const std::string message = test::message_of([&] { make_lattice_mesh(surface, 4); });

  EXPECT_EQ(message.substr(0, 44), "make_lattice_mesh: surface: is not closed: 0");
}
}  // namespace
}  // namespace tetwarp

/// @file test_look_surfaces.cpp
/// Live windows of bodies that touch with a coarser surface than the one for the eye.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "host/base/point3.hpp"
#include "host/scene/shapes/shape_surface.hpp"
#include "host/view/look/scene_look.hpp"
#include "host/view/look/surface_values.hpp"
#include "host/view/screens/scene_sharer.hpp"
#include "tests/view/live_scene.hpp"

namespace tetwarp::test {
namespace {
using namespace view;

const Shape lens = EllipsoidShape{{0.1, 0.08, 0.05}};

/// A soft lens, given as a fine surface with a coarser one that touches, falls on a floor.
Scene lens_scene() {
  Scene scene;
  scene.time_step = 0.01;
  Body body;
  body.name = "lens";
  body.geometry = make_shape_surface(lens, 1500);
  body.surface = make_shape_surface(lens, 200);
  body.lattice = Lattice{.tets = 100};
  body.material = {2e4, 0.3, 1000};
  body.pose = {.position = {0.3, -0.2, 0.055}};
  scene.bodies = {body};
  scene.obstacles = {{.name = "floor", .geometry = PlaneObstacle{}}};
  return scene;
}

/// At the start the points are those of the given surface where the pose puts them; after the body
/// has moved they are those that screens compute, but for rounding to float32.
TEST(LookSurfaces, AreWhatWindowsAndScreensDraw) {
  ViewOptions options;
  options.paused = true;
  const Surface fine = make_shape_surface(lens, 1500);
  LiveSimulation simulation(lens_scene(), options, {});
  const ViewScene view = view_scene_of(simulation, options);
  const SceneSharer sharer(simulation, view, options);
  SharedState state;
  simulation.set_listener([&](const Simulator& simulator, const LiveFrame& frame) {
    state = sharer.state(simulator, frame);
  });
  EXPECT_EQ(view.triangles[0], fine.triangles);
  simulation.begin();
  const std::vector<Point3> start = frame_at(simulation, 0).points[0];
  ASSERT_EQ(start.size(), fine.points.size());
  for (std::size_t p = 0; p < start.size(); ++p) {
    EXPECT_LT(norm(minus(start[p], plus(fine.points[p], {0.3, -0.2, 0.055}))), 1e-12);
  }
  simulation.give({.kind = OrderKind::grab, .body = 0, .point = start[0]});
  simulation.give({.kind = OrderKind::pull, .point = plus(start[0], {0.02, 0.03, 0.05})});
  for (int n = 0; n < 8; ++n) simulation.give({.kind = OrderKind::step});
  const std::vector<Point3> moved = frame_at(simulation, 8).points[0];
  simulation.end();

  const SharedScene shared = scene_of(bytes_of(sharer.scene()));
  LiveFrame frame;
  set_frame(shared, state, frame);

  EXPECT_EQ(shared.bodies[0].triangles, fine.triangles);
  EXPECT_GT(norm(minus(moved[0], start[0])), 0.001);
  ASSERT_EQ(frame.points[0].size(), moved.size());
  for (std::size_t p = 0; p < moved.size(); ++p) {
    // Coordinates below 0.5 m have float32 units of at most 2^-25 m; four weights add up.
    EXPECT_LT(norm(minus(frame.points[0][p], moved[p])), 2e-7);
  }
}

/// Gaps are those of the nearest points of the surface that touches, stresses lie within those of
/// the tetrahedra.
TEST(LookSurfaces, HaveTheValuesOfTheBody) {
  Simulator simulator(lens_scene());
  const LookSurfaces looks(simulator);
  SurfaceValues values(simulator, looks);
  for (int n = 0; n < 20; ++n) simulator.step();
  ASSERT_FALSE(simulator.contacts().empty());
  const std::vector<Point3>& fine = looks.drawn(0).points;
  const std::vector<Point3>& coarse = simulator.body(0).surface.points;

  const std::vector<float> gaps = values.of(SurfaceQuantity::gap)[0];
  const std::vector<float> stresses = values.of(SurfaceQuantity::stress)[0];

  std::vector<float> of_coarse(coarse.size(), NAN);
  for (const ContactPoint& contact : simulator.contacts()) {
    const ContactPlace& place = contact.body_a == 0 ? contact.place_a : contact.place_b;
    for (std::size_t n = 0; n < 3; ++n) {
      if (place.point[n] < 0 || !(place.weight[n] > 0)) continue;
      float& least = of_coarse[static_cast<std::size_t>(place.point[n])];
      least = std::fmin(least, static_cast<float>(contact.gap));
    }
  }
  ASSERT_EQ(gaps.size(), fine.size());
  ASSERT_EQ(stresses.size(), fine.size());
  const std::vector<double> of_cells = simulator.cell_stresses(0);
  const double most = *std::ranges::max_element(of_cells);
  int found = 0;
  for (std::size_t p = 0; p < fine.size(); ++p) {
    const auto nearest = std::ranges::min_element(
        coarse, {}, [&](const Point3& x) { return norm(minus(x, fine[p])); });
    const float expected = of_coarse[static_cast<std::size_t>(nearest - coarse.begin())];
    EXPECT_EQ(std::isnan(gaps[p]), std::isnan(expected));
    if (!std::isnan(expected)) {
      EXPECT_EQ(gaps[p], expected);
    }
    found += !std::isnan(gaps[p]);
    EXPECT_GE(stresses[p], 0);
    EXPECT_LE(stresses[p], most * (1 + 1e-6));
  }
  EXPECT_GT(found, 5);
  EXPECT_LT(found, static_cast<int>(fine.size()) / 2);
}

}  // namespace
}  // namespace tetwarp::test

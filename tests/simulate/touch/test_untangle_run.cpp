/// @file test_untangle_run.cpp
/// Whole runs of scenes that overlap at the start: bodies grow back or relax without intersecting.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "host/simulate/start/start_check.hpp"
#include "host/simulate/surfaces/surface_motion.hpp"
#include "tests/simulate/touch_scenes.hpp"
#include "tests/support/message_of.hpp"

namespace tetwarp::test {
namespace {

/// Whether any two bodies of a running scene intersect.
class Intersections {
 public:
  explicit Intersections(const Scene& scene)
      : touch_(scene), detector_(make_cpu_detector(touch_.surfaces.surfaces, {})) {
    surface_places(touch_.surfaces, touch_.model, touch_.model.start, 1, places_);
  }

  bool has_any(const Simulator& simulator) {
    for (std::size_t b = 0; b < simulator.scene().bodies.size(); ++b) {
      const std::vector<Point3> points = simulator.surface_positions(b);
      for (std::int32_t v = touch_.body(b).first_vertex; v < touch_.body(b).vertex_end; ++v) {
        places_.vertices[static_cast<std::size_t>(v)] =
            at(points, at(touch_.surfaces.surface_point, v));
      }
    }
    const auto conflicts = start_conflicts(touch_.surfaces, places_, *detector_, 1);
    return std::ranges::any_of(conflicts, &StartConflict::is_intersection);
  }

 private:
  TouchScene touch_;
  std::unique_ptr<Detector> detector_;
  SurfacePlaces places_;
};

Scene overlapping() {
  Scene scene = scene_of({soft_ball("left", {0, 0, 0}), soft_ball("right", {0.12, 0.01, 0.02}),
                          soft_ball("top", {0.05, 0.02, 0.1})},
                         0.005);
  scene.solver.linear_tolerance = 1e-6;
  scene.gravity = {0, 0, 0};
  scene.obstacles = {{"floor", PlaneObstacle{{0, 0, 1}, {0, 0, -0.08}}, {}, {}}};
  return scene;
}

/// Least and largest volume of the elements over that at rest.
std::array<double, 2> volumes(const Simulator& simulator) {
  double least = 9, largest = 0;
  for (std::size_t b = 0; b < simulator.scene().bodies.size(); ++b) {
    for (const double j : simulator.cell_jacobians(b)) {
      least = std::min(least, j);
      largest = std::max(largest, j);
    }
  }
  return {least, largest};
}

TEST(UntangledRun, GrowsBackWithoutIntersecting) {
  const Scene scene = overlapping();
  SimulateOptions options;
  options.untangle = true;
  Simulator simulator(scene, options);
  Intersections intersections(scene);
  EXPECT_LT(volumes(simulator)[1], 0.9);
  for (int n = 0; n < 160; ++n) {
    ASSERT_FALSE(intersections.has_any(simulator)) << n;
    ASSERT_TRUE(simulator.step());
    ASSERT_GT(volumes(simulator)[0], 0) << n;
    ASSERT_LT(volumes(simulator)[1], 1.5) << n;
  }
  EXPECT_GT(volumes(simulator)[0], 0.9);
  EXPECT_LT(volumes(simulator)[1], 1.1);
}

/// A checkpoint in the growth goes on bit for bit.
TEST(UntangledRun, GoesOnFromACheckpoint) {
  SimulateOptions options;
  options.untangle = true;
  Simulator one(overlapping(), options), other(overlapping(), options);
  run(one, 10);
  other.restore(one.checkpoint());
  run(one, 10);
  run(other, 10);
  for (std::size_t b = 0; b < 3; ++b) EXPECT_EQ(one.node_positions(b), other.node_positions(b));
}

TEST(CagedRun, RelaxesWithoutIntersecting) {
  Scene scene = overlapping();
  for (Body& body : scene.bodies) body.cage_start = true;
  Simulator simulator(scene);
  Intersections intersections(scene);
  EXPECT_GT(simulator.record().energy.elastic, 0);
  const double start = simulator.record().energy.total();
  for (int n = 0; n < 100; ++n) {
    ASSERT_FALSE(intersections.has_any(simulator)) << n;
    ASSERT_TRUE(simulator.step());
    ASSERT_GT(volumes(simulator)[0], 0) << n;
  }
  EXPECT_LT(simulator.record().energy.total(), start);
  EXPECT_GT(volumes(simulator)[0], 0.9);
}

TEST(OverlappingStart, IsAnError) {
  const std::string message = message_of([] { Simulator{overlapping()}; });
  EXPECT_NE(message.find("' at the start, at ("), std::string::npos) << message;
}

TEST(OverlappingStart, IsNotUntangledByTheReference) {
  SimulateOptions options;
  options.untangle = true;
  options.backend = Backend::reference;
  EXPECT_EQ(message_of([&] {
              Simulator{overlapping(), options};
            }),
            "untangle: backend reference cannot let bodies grow; use backend cpu");
}

}  // namespace
}  // namespace tetwarp::test

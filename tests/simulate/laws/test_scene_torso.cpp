/// @file test_scene_torso.cpp
/// Laws of the scene `torso`, at its full size: its liver is dragged and let go.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tetwarp/make.hpp>
#include <tetwarp/simulate.hpp>
#include <tetwarp/warp.hpp>
#include <vector>

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"
#include "tests/scene/scene_texts.hpp"
#include "tests/simulate/law_scenes.hpp"

namespace tetwarp::test {
namespace {

double farthest(const std::vector<Point3>& a, const std::vector<Point3>& b) {
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, norm(minus(a[k], b[k])));
  return most;
}

/// The handle of the scene holds on until all is still, and lets go.
TEST(SceneTorso, HandleAndBaseCarryTheWeightAndNothingIsLeftOfTheDrag) {
  Scene scene = shipped("torso");
  scene.solver.linear_tolerance = 1e-12;
  Scene alone = scene;
  alone.handles.clear();
  Simulator rest(alone);
  run(rest, 400);
  Path& path = scene.handles[0].path;
  ASSERT_FALSE(path.back().displacement.has_value());
  path.back().time = 2;
  path[path.size() - 2].time = 1.99;
  Simulator simulator(scene);

  run(simulator, 390);
  const BodyRecord& body = simulator.record().bodies[0];
  const Point3 carried = plus(body.handle_force, body.support_force);
  const Point3 weight{0, 0, earth * simulator.body(0).mass};
  EXPECT_GT(norm(body.handle_force), 100);
  EXPECT_LT(norm(minus(carried, weight)), 1e-6 * norm(body.handle_force));
  EXPECT_GT(farthest(simulator.node_positions(0), rest.node_positions(0)), 0.02);

  run(simulator, 410);
  const double size = 0.384;
  EXPECT_LT(farthest(simulator.node_positions(0), rest.node_positions(0)), 1e-6 * size);
  EXPECT_EQ(simulator.record().inverted, 0);
}

/// With one layer of its cells held, those keep their voxels: only what moves is warped again.
TEST(SceneTorso, OnlyTetrahedraThatMoveAreWarpedAgain) {
  Scene scene = shipped("torso");
  const double held = 0.05;
  std::get<BoxSelection>(scene.bodies[0].fixed.at(0)).high[2] = held;
  Simulator simulator(scene);
  Volume source = make_phantom({256, 160, 122});
  source.grid.spacing = {0.0015, 0.0015, 0.0015};
  source.grid.origin = {0, 0, 0};
  const BodyMesh& body = simulator.body(0);
  Warper warper(source, body.mesh);
  std::vector<float> voxels(index_of(source.grid.voxel_count()));
  void* volumes[] = {voxels.data()};
  const WarpTarget target{.volumes = volumes, .holds_previous = true};
  std::int64_t still = 0;
  for (const auto& tet : body.mesh.tets) {
    still += std::ranges::all_of(tet, [&](std::int32_t node) {
      return body.mesh.rest_positions[index_of(node)][2] <= held;
    });
  }
  ASSERT_GT(still, 100);
  run(simulator, 40);
  const StepReport first = warper.step({simulator.node_positions(0)}, target);
  for (int frame = 0; frame < 3; ++frame) {
    run(simulator, 10);
    const StepReport report = warper.step({simulator.node_positions(0)}, target);
    EXPECT_EQ(report.counts.tets_unchanged, still) << frame;
    EXPECT_GT(report.counts.cells_unchanged, report.counts.cells / 5) << frame;
    EXPECT_LT(report.counts.candidate_pairs, first.counts.candidate_pairs) << frame;
  }
}

}  // namespace
}  // namespace tetwarp::test

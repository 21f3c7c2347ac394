/// @file test_scene_short.cpp
/// Short variants of all scenes that ship: images of an eighth of the resolution or less, coarser
/// lattices, the first steps. Whole runs are in test_scene_laws.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tetwarp/scene_io.hpp>
#include <vector>

#include "tests/simulate/shipped_scenes.hpp"
#include "tests/simulate/stress_watch.hpp"

namespace tetwarp::test {
namespace {

/// Whether one of two bodies touches nothing, or a coupling joins them that lets them cross.
bool may_cross(const Scene& scene, std::size_t a, std::size_t b) {
  const std::string &first = scene.bodies[a].name, &second = scene.bodies[b].name;
  return !scene.bodies[a].collide || !scene.bodies[b].collide ||
         std::any_of(scene.couplings.begin(), scene.couplings.end(), [&](const Coupling& c) {
           return !c.collide &&
                  ((c.a == first && c.b == second) || (c.a == second && c.b == first));
         });
}

/// Of every body with mass and without alpha damping the largest |mass (v' - v) / dt - forces -
/// weight| of the steps so far, and the largest sum of the sizes of these [N].
class Balances {
 public:
  explicit Balances(std::size_t count) : rest_(count), size_(count) {}

  void add_step(Simulator& simulator, const StepRecord& before) {
    const Scene& scene = simulator.scene();
    const StepRecord& now = simulator.record();
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      const double mass = simulator.body(b).mass;
      if (scene.bodies[b].damping.alpha != 0 || mass == 0) continue;
      const BodyRecord& body = now.bodies[b];
      Point3 rest = times(-mass / scene.time_step, minus(body.velocity, before.bodies[b].velocity));
      double size = norm(rest);
      for (const Point3& force :
           {times(mass, scene.gravity), body.contact_force, body.support_force, body.handle_force,
            body.coupling_force, body.load_force}) {
        rest = plus(rest, force);
        size += norm(force);
      }
      rest_[b] = std::max(rest_[b], norm(rest));
      size_[b] = std::max(size_[b], size);
    }
  }

  void expect_within(double part) const {
    for (std::size_t b = 0; b < rest_.size(); ++b) EXPECT_LE(rest_[b], part * size_[b]) << b;
  }

 private:
  std::vector<double> rest_, size_;
};

/// What every scene obeys. @param balance  of forces, as a part of them
void expect_laws(Simulator& simulator, int steps, int every, double balance) {
  const double start = simulator.record().energy.total();
  const std::size_t count = simulator.scene().bodies.size();
  Balances balances(count);
  double size = 0;
  std::int64_t crossings = 0;
  for (int n = 1; n <= steps; ++n) {
    const StepRecord before = simulator.record();
    simulator.step();
    const StepRecord& record = simulator.record();
    balances.add_step(simulator, before);
    size = std::max({size, record.energy.kinetic, record.energy.elastic});
    EXPECT_TRUE(record.converged) << n;
    EXPECT_EQ(record.clamped_islands, 0) << n;
    EXPECT_GT(record.smallest_distance, 0) << n;
    EXPECT_LE(record.energy.total() - record.energy.work, start + 1e-4 * size) << n;
    if (n % every != 0) continue;
    const std::vector<Surface> surfaces = surfaces_now(simulator);
    for (std::size_t a = 0; a < count; ++a) {
      for (const Point3& x : surfaces[a].points) EXPECT_TRUE(is_finite(x));
      for (std::size_t b = a + 1; b < count; ++b) {
        if (may_cross(simulator.scene(), a, b)) continue;
        crossings += crossing_count(surfaces[a], surfaces[b]);
      }
    }
  }
  EXPECT_EQ(crossings, 0);
  balances.expect_within(balance);
}

/// The jello and the first six sweets.
Scene few_candies() {
  Scene scene = coarse_candy();
  scene.bodies.erase(scene.bodies.begin() + 7, scene.bodies.end());
  return scene;
}

TEST(ShortScenes, CandyFallsAndLandsWithoutCrossing) {
  Simulator simulator(few_candies());
  expect_laws(simulator, 30, 5, 1e-4);
  EXPECT_GT(simulator.record().contacts, 10);
  EXPECT_GT(simulator.record().adhered_area, 0);
}

/// Among contacts and bonds.
TEST(ShortScenes, CandyGoesOnFromACheckpointWithTheSameBits) {
  Simulator whole(few_candies()), second(few_candies());
  for (int n = 0; n < 25; ++n) whole.step();
  ASSERT_GT(whole.record().adhered_area, 0);
  second.restore(whole.checkpoint());
  for (int n = 0; n < 5; ++n) {
    whole.step();
    second.step();
  }
  for (std::size_t b = 0; b < whole.scene().bodies.size(); ++b) {
    EXPECT_EQ(second.surface_positions(b), whole.surface_positions(b)) << b;
  }
  EXPECT_EQ(second.record().adhered_area, whole.record().adhered_area);
  EXPECT_EQ(second.record().energy.total(), whole.record().energy.total());
}

/// The friction and adhesion that the paper chose.
Scene with_the_papers_laws(Scene scene) {
  scene.solver.pyramid = scene.solver.restrictive = true;
  return scene;
}

TEST(ShortScenes, CandyAndLipsBondByThePapersLawsToo) {
  Simulator candy(with_the_papers_laws(few_candies()));
  expect_laws(candy, 30, 15, 1e-4);
  EXPECT_GT(candy.record().adhered_area, 0);
  Simulator lips(with_the_papers_laws(shipped("mouth")));
  expect_laws(lips, 20, 20, 1e-4);
  EXPECT_GT(lips.record().adhered_area, 0);
}

TEST(ShortScenes, CantileverBendsDown) {
  Simulator simulator(shipped("cantilever"));
  expect_laws(simulator, 20, 20, 1e-4);
  EXPECT_LT(simulator.record().energy.gravity, 0);
}

/// After a period all nodes are where they were, to the bit; nothing is halved or solved.
TEST(ShortScenes, CarpsReturnAfterAPeriod) {
  const Scene scene = changed("carps", {{"[204, 202, 512]", "[26, 26, 64]"},
                                        {"[0.001, 0.001, 0.001]", "[0.008, 0.008, 0.008]"},
                                        {"\"triangles\": 4000", "\"triangles\": 500"}});
  Simulator simulator(scene);
  std::vector<std::vector<Point3>> start;
  for (std::size_t b = 0; b < 8; ++b) start.push_back(simulator.node_positions(b));
  for (int n = 0; n < 60; ++n) {
    simulator.step();
    EXPECT_EQ(simulator.record().inverted, 0);
    EXPECT_EQ(simulator.record().linear_iterations, 0);
    EXPECT_EQ(simulator.record().contacts, 0);
    for (std::size_t b = 0; b < 8; ++b) {
      EXPECT_GT(std::ranges::min(simulator.cell_jacobians(b)), 0.5) << n;
    }
    if (n == 29) {
      EXPECT_NE(simulator.node_positions(0), start[0]);
    }
  }
  for (std::size_t b = 0; b < 8; ++b) EXPECT_EQ(simulator.node_positions(b), start[b]) << b;
}

TEST(ShortScenes, ChainAndTopKeepTheirBalances) {
  Simulator chain(shipped("chain"));
  expect_laws(chain, 50, 50, 1e-4);
  Simulator top(shipped("top"));
  const double spin = norm(top.record().angular_momentum);
  expect_laws(top, 100, 100, 1e-9);
  EXPECT_NEAR(norm(top.record().angular_momentum) / spin, 1, 1e-12);
}

TEST(ShortScenes, ClothsSwingToTheWallAndOneStaysLonger) {
  double bonded[2] = {0, 0};
  for (const int k : {0, 1}) {
    Scene scene = changed(k == 0 ? "cloth" : "cloth_peels", {{"[20, 20]", "[10, 10]"}});
    Simulator simulator(scene);
    expect_laws(simulator, 110, 110, 1e-4);
    EXPECT_GT(simulator.record().contacts, 0) << "it meets the wall after half a second";
    for (int n = 110; n < 240; ++n) simulator.step();
    bonded[k] = simulator.record().adhered_area;
  }
  EXPECT_GT(bonded[0], 1.5 * bonded[1]);
}

/// Contacts that touch and hardly push, as where it leaves the wall, have residuals, too.
TEST(ShortScenes, ClothWithoutAdhesionLeavesTheWall) {
  Scene scene = shipped("cloth");
  scene.contact.material.adhesion.reset();
  Simulator simulator(scene);
  std::int64_t most = 0;
  for (int n = 0; n < 260; ++n) {
    simulator.step();
    const StepRecord& record = simulator.record();
    ASSERT_TRUE(record.converged) << n;
    most = std::max(most, record.contacts);
    ASSERT_LE(record.contact_residual, 1e-4) << n;
  }
  EXPECT_GT(most, 200);
  EXPECT_LT(simulator.record().contacts, most / 4);
}

TEST(ShortScenes, SheetSwingsDown) {
  Simulator simulator(shipped("sheet"));
  const double height = simulator.record().bodies[0].center[2];
  expect_laws(simulator, 40, 40, 1e-4);
  EXPECT_LT(simulator.record().bodies[0].center[2], height - 0.1);
}

TEST(ShortScenes, LipsBondWhileTheJawPresses) {
  Scene scene = shipped("mouth");
  Simulator simulator(scene);
  expect_laws(simulator, 30, 30, 1e-4);
  EXPECT_GT(simulator.record().adhered_area, 0);
}

/// The points of the lips' surfaces are nodes, so that the forces that nodes feel leave no choice
/// which of them press.
TEST(ShortScenes, LipsBondTheSameAreaWhateverTheTolerance) {
  double bonded[3] = {};
  for (const int k : {0, 1, 2}) {
    Scene scene = shipped("mouth");
    scene.solver.contact_tolerance = std::pow(10.0, -4 - k);
    Simulator simulator(scene);
    for (int n = 0; n < 40; ++n) simulator.step();
    bonded[k] = simulator.record().adhered_area;
  }
  EXPECT_GT(bonded[0], 5e-5);
  EXPECT_NEAR(bonded[1] / bonded[0], 1, 0.05);
  EXPECT_NEAR(bonded[2] / bonded[0], 1, 0.05);
}

/// Coarse fruits, 4 mm above the slope.
TEST(ShortScenes, OrangesTouchDown) {
  Scene scene = changed("oranges", {{"[198, 199, 160]", "[50, 50, 40]"},
                                    {"[0.0004, 0.0004, 0.0005]", "[0.0016, 0.0016, 0.002]"},
                                    {"\"triangles\": 3200", "\"triangles\": 400"}});
  scene.bodies.erase(scene.bodies.begin() + 2, scene.bodies.end());
  for (Body& body : scene.bodies) body.pose.position[2] = 0.044;
  Simulator simulator(scene);
  expect_laws(simulator, 100, 25, 1e-4);
  EXPECT_GT(simulator.record().contacts, 0);
  EXPECT_GE(simulator.record().smallest_distance, 0.5 * simulator.thickness());
  EXPECT_LT(simulator.record().smallest_distance, 2 * simulator.thickness());
}

TEST(ShortScenes, PeelsAStripFromTheFloor) {
  Simulator simulator(changed("peel", {{"[40, 4]", "[20, 2]"}}));
  expect_laws(simulator, 400, 400, 1e-4);
  EXPECT_GT(simulator.record().bodies[0].support_force[2], 0) << "the end is pulled up";
  EXPECT_LT(simulator.record().adhered_area, 0.98 * 0.2 * 0.02);
  EXPECT_GT(simulator.record().adhered_area, 0.5 * 0.2 * 0.02);
}

TEST(ShortScenes, ShoulderHangsInItsHandles) {
  Simulator simulator(shipped("shoulder"));
  EXPECT_GT(simulator.record().smallest_distance, simulator.thickness());
  expect_laws(simulator, 25, 25, 1e-4);
}

/// Muscles overlap bones where they are drawn.
TEST(ShortScenes, ShoulderCannotStartWithoutItsCages) {
  Scene scene = shipped("shoulder");
  for (Body& body : scene.bodies) body.cage_start = false;
  const std::string message = message_of([&] { Simulator{scene}; });
  EXPECT_NE(message.find("intersects bodies["), std::string::npos) << message;
}

/// As the organ is dragged, the base and the handle carry the weight and what speeds up.
TEST(ShortScenes, TorsoIsDraggedByItsLiver) {
  Simulator simulator(changed("torso", {{"[256, 160, 122]", "[64, 40, 30]"},
                                        {"[0.0015, 0.0015, 0.0015]", "[0.006, 0.006, 0.006]"},
                                        {"\"triangles\": 20000", "\"triangles\": 2000"}}));
  expect_laws(simulator, 60, 60, 1e-4);
  EXPECT_GT(simulator.record().bodies[0].handle_force[0], 1);
  EXPECT_GT(simulator.record().energy.work, 0);
}
}  // namespace
}  // namespace tetwarp::test

/// @file test_scene_laws.cpp
/// Laws of the scenes with contact that ship: whole runs, or their first part.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tetwarp/scene_io.hpp>

#include "tests/simulate/shipped_scenes.hpp"
#include "tests/simulate/stress_watch.hpp"

namespace tetwarp::test {
namespace {

/// A cloth that swings against a wall at x = 0.
struct Swing {
  double first_contact = -1, peak_area = 0, half_time = -1;  ///< [s], [m^2], [s]
  double mean_distance = 0;                                  ///< from the wall at the end [m]
  double lowest = 1;                                         ///< [m]
};

Swing swing(const std::string& name, std::int64_t cells) {
  Scene scene = shipped(name);
  std::get<Sheet>(scene.bodies[0].geometry).cells = {cells, cells};
  Simulator simulator(scene);
  Swing swing;
  for (std::int64_t n = 0; n < scene.step_count(); ++n) {
    simulator.step();
    const StepRecord& record = simulator.record();
    if (record.contacts > 0 && swing.first_contact < 0) swing.first_contact = record.time;
    if (record.adhered_area > swing.peak_area) {
      swing.peak_area = record.adhered_area;
      swing.half_time = -1;
    } else if (record.adhered_area < swing.peak_area / 2 && swing.half_time < 0) {
      swing.half_time = record.time;
    }
    for (const Point3& x : simulator.node_positions(0)) swing.lowest = std::min(swing.lowest, x[0]);
  }
  const auto nodes = simulator.node_positions(0);
  for (const Point3& x : nodes) swing.mean_distance += x[0] / static_cast<double>(nodes.size());
  return swing;
}

TEST(SceneLaws, ClothStaysOnTheWallWhateverItsMesh) {
  for (const auto& [cells, area, distance] :
       {std::tuple{10, 0.1150, 9.1e-3}, {20, 0.1133, 8.8e-3}, {40, 0.1133, 8.6e-3}}) {
    const Swing found = swing("cloth", cells);
    EXPECT_NEAR(found.first_contact, 0.5, 0.0051) << cells;
    EXPECT_NEAR(found.peak_area / area, 1, 0.03) << cells;
    EXPECT_NEAR(found.mean_distance / distance, 1, 0.06) << cells;
    EXPECT_GT(found.lowest, 0) << cells;
  }
}

TEST(SceneLaws, ClothPeelsOffTheWallWhateverItsMesh) {
  for (const auto& [cells, area, half, distance, tolerance] :
       {std::tuple{10, 0.1115, 0.910, 17.2e-3, 0.15},
        {20, 0.1112, 0.955, 17.7e-3, 0.04},
        {40, 0.1114, 0.955, 17.5e-3, 0.04}}) {
    const Swing found = swing("cloth_peels", cells);
    EXPECT_NEAR(found.first_contact, 0.5, 0.0051) << cells;
    EXPECT_NEAR(found.peak_area / area, 1, 0.01) << cells;
    EXPECT_NEAR(found.half_time / half, 1, 0.1) << cells;
    EXPECT_NEAR(found.mean_distance / distance, 1, tolerance) << cells;
    EXPECT_GT(found.lowest, 0) << cells;
  }
}

/// The lips bond while the jaw presses; as it opens, bonds end on both sides alike, but for those
/// at the corners, where springs press the lips together.
TEST(SceneLaws, MouthOpensSymmetricallyAndLosesItsBonds) {
  Scene scene = shipped("mouth");
  scene.solver.linear_tolerance = 1e-9;  // that of the scene lets both sides differ by as much
  Simulator simulator(scene);
  double bonded = 0, asymmetry = 0;
  for (std::int64_t n = 0; n < scene.step_count(); ++n) {
    simulator.step();
    const StepRecord& record = simulator.record();
    bonded = std::max(bonded, record.adhered_area);
    for (std::size_t lip = 0; lip < 2; ++lip) {
      asymmetry = std::max(asymmetry, std::abs(record.bodies[lip].center[0]));
    }
    EXPECT_GT(record.smallest_distance, 0) << n;
  }
  EXPECT_GT(bonded, 5e-5);
  EXPECT_LT(asymmetry, 1e-6);
  EXPECT_LT(simulator.record().adhered_area, 0.15 * bonded);
  for (const ContactPoint& contact : simulator.contacts()) {
    const double reach = 0.004;  // of the springs around the corners, up to x = +-0.0275
    EXPECT_GT(std::abs(contact.position[0]), 0.0275 - reach);
  }
}

/// Until all have landed: the first 2.4 s.
TEST(SceneLaws, CandyLandsWithoutCrossingAnything) {
  Simulator simulator(shipped("candy"));
  const double start = simulator.record().energy.total();
  const Watch watch = watch_steps(simulator, 300, 60);
  SCOPED_TRACE(testing::Message() << watch);
  EXPECT_TRUE(watch.is_finite);
  EXPECT_EQ(watch.crossings, 0);
  EXPECT_EQ(watch.unconverged, 0);
  EXPECT_GT(watch.least_distance, 0);
  EXPECT_LT(simulator.record().energy.total(), 0.5 * start);
  EXPECT_LT(simulator.record().energy.kinetic, 1e-3 * start);
  EXPECT_GT(simulator.record().adhered_area, 0);
  EXPECT_LT(pushing_count(simulator), 1000);
}

/// After the last sweet has landed, energy falls; as many contacts carry an impulse as the paper
/// counts, and half as many again with adhesion as without.
TEST(SceneLaws, CoarseCandyComesToRest) {
  double pushing[2] = {};
  for (const bool adheres : {false, true}) {
    Scene scene = coarse_candy();
    if (!adheres) remove_adhesion(scene);
    Simulator simulator(scene);
    std::int64_t most = 0;
    double energy = 0;
    for (int n = 0; n < 500; ++n) {
      simulator.step();
      const StepRecord& record = simulator.record();
      EXPECT_TRUE(record.converged) << n;
      EXPECT_GT(record.smallest_distance, 0) << n;
      if (n > 150) {
        EXPECT_LT(record.energy.total(), energy + 1e-7) << n;  // of 2.4 J at the start
      }
      energy = record.energy.total();
      const std::int64_t count = pushing_count(simulator);
      most = std::max(most, count);
      pushing[adheres] += static_cast<double>(count) / 500;
    }
    EXPECT_LT(most, 800) << adheres;
    EXPECT_GT(pushing[adheres], 100) << adheres;
    EXPECT_LT(pushing[adheres], 250) << adheres;
  }
  EXPECT_GT(pushing[1] / pushing[0], 1.3);
  EXPECT_LT(pushing[1] / pushing[0], 1.9);
}

/// All of its 2,000 steps. A point that comes from beyond twice the thickness is held where a step
/// would end at less than half of it.
TEST(SceneLaws, OrangesLandAndRollAboveTheFloor) {
  Simulator simulator(shipped("oranges"));
  double energy = simulator.record().energy.total();
  int near = 0;
  for (int n = 0; n < 2000; ++n) {
    simulator.step();
    const StepRecord& record = simulator.record();
    EXPECT_TRUE(record.converged) << n;
    EXPECT_EQ(record.clamped_islands, 0) << n;
    EXPECT_GE(record.smallest_distance, 0.5 * simulator.thickness()) << n;
    EXPECT_LT(record.energy.total(), energy) << n;
    energy = record.energy.total();
    near += record.smallest_distance < 0.9 * simulator.thickness();
    if (n % 100 != 99) continue;
    const std::vector<Surface> surfaces = surfaces_now(simulator);
    for (std::size_t b = 0; b < 6; ++b) {
      for (const Point3& x : surfaces[b].points) {
        ASSERT_GE(x[2], 0.5 * simulator.thickness()) << n;
      }
      for (std::size_t other = 0; other < b; ++other) {
        EXPECT_EQ(crossing_count(surfaces[other], surfaces[b]), 0) << n;
      }
    }
  }
  EXPECT_LT(near, 100);
  for (std::size_t b = 0; b < 6; ++b) {
    EXPECT_GT(simulator.record().bodies[b].velocity[0], 0.5) << "it rolls down";
  }
}

/// Of the strip as it ships: work less what is stored over the area that comes off, and the force
/// less the weight of what hangs over the width. The material damping takes a part.
TEST(SceneLaws, PeelTakesItsEnergyTimesTheArea) {
  const Scene scene = shipped("peel");
  const double energy = 2, width = 0.02;
  Simulator simulator(scene);
  double force = 0, work = 0, area = 0;
  const auto stored = [](const SceneEnergy& e) { return e.kinetic + e.elastic + e.gravity; };
  for (int n = 1; n <= 3500; ++n) {
    simulator.step();
    if (n < 500) continue;
    const StepRecord& record = simulator.record();
    if (n == 500) {
      work = record.energy.work - stored(record.energy);
      area = record.adhered_area;
      continue;
    }
    const std::vector<Point3> nodes = simulator.node_positions(0);
    const auto hanging =
        std::count_if(nodes.begin(), nodes.end(), [](const Point3& x) { return x[2] > 1e-3; });
    const double weight = earth * simulator.body(0).mass * static_cast<double>(hanging) /
                          static_cast<double>(nodes.size());
    const Point3& pull = record.bodies[0].support_force;
    force += (pull[2] - pull[0] - weight) / (energy * width) / 3000;
  }
  const StepRecord& record = simulator.record();
  EXPECT_NEAR(force, 1, 0.03);
  EXPECT_NEAR(
      (record.energy.work - stored(record.energy) - work) / (energy * (area - record.adhered_area)),
      1, 0.03);
}

/// With the finger held still. Muscles overlap bones where they are drawn: the cages free them.
TEST(SceneLaws, ShoulderSettlesUnderItsWeight) {
  Scene scene = shipped("shoulder");
  for (Handle& handle : scene.handles) handle.path.clear();
  scene.solver.contact_tolerance = 1e-8;
  scene.solver.linear_tolerance = 1e-10;
  Simulator simulator(scene);
  EXPECT_GT(simulator.record().smallest_distance, simulator.thickness());
  double energy = simulator.record().energy.total();
  std::int64_t contacts = 0;
  for (int n = 0; n < 500; ++n) {
    simulator.step();
    const StepRecord& record = simulator.record();
    EXPECT_EQ(record.clamped_islands, 0) << n;
    EXPECT_GT(record.smallest_distance, 0) << n;
    EXPECT_LT(record.energy.total(), energy + 1e-9) << n;  // of 0.2 J
    energy = record.energy.total();
    contacts = std::max(contacts, record.contacts);
  }
  EXPECT_GE(contacts, 5);
  EXPECT_LT(contacts, 200);
  // Handles, couplings and contacts carry each part.
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const BodyRecord& body = simulator.record().bodies[b];
    const double weight = earth * simulator.body(b).mass;
    const Point3 held = plus(plus(body.handle_force, body.coupling_force), body.contact_force);
    EXPECT_LT(norm(minus(held, {0, 0, weight})), 1e-6 * weight) << scene.bodies[b].name;
  }
}

/// Both fingers press the deltoid between them for most of ten seconds.
TEST(SceneLaws, ShoulderIsPalpatedByTwoFingers) {
  Simulator simulator(shipped("shoulder"));
  const std::size_t inside = simulator.scene().bodies.size() - 1, outside = inside - 1;
  ASSERT_EQ(simulator.scene().bodies[inside].name, "finger_inside");
  int touched = 0;
  for (int n = 1; n <= 2000; ++n) {
    simulator.step();
    const StepRecord& record = simulator.record();
    EXPECT_TRUE(record.converged) << n;
    EXPECT_EQ(record.clamped_islands, 0) << n;
    EXPECT_GT(record.smallest_distance, 0) << n;
    touched += norm(record.bodies[inside].contact_force) > 0.1 &&
               norm(record.bodies[outside].contact_force) > 0.1;
  }
  EXPECT_GT(touched, 1000);
}

}  // namespace
}  // namespace tetwarp::test

/// @file test_law_peel.cpp
/// Adhesion through whole steps: the force that peels a strip off.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/simulate/law_scenes.hpp"

namespace tetwarp::test {
namespace {

/// Of a strip of `cells` along its length whose end is led upwards and back as fast, so that the
/// strip leaves the floor at a right angle.
struct Peel {
  double force = 0;     ///< per W width: work over the length of strip that comes off
  double sideways = 0;  ///< force along x, per W width
  double energy = 0;    ///< work less what is stored, per W and area that came off
};

/// @param begin, end  [s] of what is averaged: rows of nodes come off every 10 s / cells
Peel peel(std::int64_t cells, double begin, double end) {
  const double energy = 2, width = 0.02, speed = 0.02, lead = 0.003;
  Body strip = sheet_body("strip", {0.2, width}, {cells, 1});
  std::get<Sheet>(strip.geometry).origin = {0, -0.01, 1.1e-4};
  strip.cloth = {0.1, 4e4, 8e3, 1e-5};
  strip.damping = {20, 2e-4};  // 2e-3 s of gamma take 1.3 % more
  strip.self = false;
  strip.driven = {{{HalfSpaceSelection{{1, 0, 0}, 0.1999}},
                   {{0, Point3{0, 0, 0}},
                    {lead / speed, Point3{0, 0, lead}},
                    {8, Point3{lead - 0.16, 0, 0.16}}}}};
  Scene scene = floor_scene({strip}, 0.002, 0);
  scene.gravity = {0, 0, 0};
  scene.solver.linear_tolerance = 1e-10;  // so that rows of nodes come off evenly
  scene.solver.contact_tolerance = 1e-6;
  scene.contact.material.adhesion = AdhesionMaterial{
      .stiffness = 8e4, .energy = energy, .viscosity = 2e-3, .initial_intensity = 1};
  Simulator simulator(scene);
  Peel result;
  const int first = static_cast<int>(std::lround(begin / scene.time_step));
  const int steps = static_cast<int>(std::lround(end / scene.time_step));
  double start_work = 0, start_area = 0, start_stored = 0;
  for (int n = 0; n < steps; ++n) {
    simulator.step();
    const StepRecord& record = simulator.record();
    const Point3& force = record.bodies[0].support_force;
    const double stored = record.energy.kinetic + record.energy.elastic + record.energy.gravity;
    if (n == first) {
      start_work = record.energy.work;
      start_area = record.adhered_area;
      start_stored = stored;
    }
    if (n < first) continue;
    result.force += (force[2] - force[0]) / (steps - first) / (energy * width);
    result.sideways += force[0] / (steps - first) / (energy * width);
    if (n + 1 == steps) {
      result.energy = (record.energy.work - start_work - stored + start_stored) /
                      (energy * (start_area - record.adhered_area));
    }
  }
  return result;
}

/// At a right angle the force is energy times width, whatever the mesh. Cells of 20, 10 and 5 mm,
/// where sqrt(energy / stiffness) is 5 mm. The force ripples with the rows of nodes that come off:
/// means are over whole rows. With the longest cells the two nodes of the first rows come off one
/// after the other and the force is far from steady until the fourth.
TEST(Peel, ForceIsEnergyTimesWidthForEveryMesh) {
  struct Mesh {
    std::int64_t cells;
    double begin, end;
  };
  for (const Mesh& mesh : {Mesh{10, 4, 7}, {20, 1.5, 3}, {40, 1.5, 3}}) {
    const Peel found = peel(mesh.cells, mesh.begin, mesh.end);
    EXPECT_NEAR(found.force, 1, 0.03) << mesh.cells;
    EXPECT_NEAR(found.energy, 1, 0.02) << mesh.cells;
    EXPECT_LT(std::abs(found.sideways), 0.1) << mesh.cells;
  }
}

}  // namespace
}  // namespace tetwarp::test

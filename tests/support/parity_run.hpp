/// @file parity_run.hpp
/// The Simulator on a back end against the reference, which derives everything from the scene by
/// itself.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <tetwarp/simulate.hpp>

#include "tests/support/body_scenes.hpp"
#include "tests/support/parity_scenes.hpp"

namespace tetwarp::test {

/// Relative, with linear_tolerance 1e-13.
constexpr double parity_tolerance = 1e-10;

inline double length_of(const Point3& p) {
  return std::hypot(p[0], p[1], p[2]);
}
inline Point3 difference_of(const Point3& a, const Point3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

/// Compares vectors of a scene with one another, relative to the largest of their kind.
class Comparison {
 public:
  void add(const Point3& a, const Point3& b) {
    size_ = std::max({size_, length_of(a), length_of(b)});
    difference_ = std::max(difference_, length_of(difference_of(a, b)));
  }
  void add(const std::vector<Point3>& a, const std::vector<Point3>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) add(a[i], b[i]);
  }
  void add(double a, double b) { add({a, 0, 0}, {b, 0, 0}); }
  void check(const char* what) const { EXPECT_LE(difference_, parity_tolerance * size_) << what; }

 private:
  double size_ = 1e-6, difference_ = 0;
};

inline void compare_records(const StepRecord& a, const StepRecord& b) {
  Comparison centers, velocities, momenta, spins, forces, energies, turns;
  ASSERT_EQ(a.bodies.size(), b.bodies.size());
  for (std::size_t i = 0; i < a.bodies.size(); ++i) {
    const BodyRecord &x = a.bodies[i], &y = b.bodies[i];
    centers.add(x.center, y.center);
    velocities.add(x.velocity, y.velocity);
    momenta.add(x.angular_momentum, y.angular_momentum);
    if (x.angular_momentum != Point3{}) spins.add(x.angular_velocity, y.angular_velocity);
    forces.add(x.support_force, y.support_force);
    forces.add(x.handle_force, y.handle_force);
    forces.add(x.coupling_force, y.coupling_force);
    forces.add(x.load_force, y.load_force);
    for (std::size_t d = 0; d < 4; ++d) turns.add(x.rotation[d], y.rotation[d]);
  }
  momenta.add(a.angular_momentum, b.angular_momentum);
  forces.add(a.coupling_forces, b.coupling_forces);
  energies.add(a.energy.kinetic, b.energy.kinetic);
  energies.add(a.energy.elastic, b.energy.elastic);
  energies.add(a.energy.gravity, b.energy.gravity);
  energies.add(a.energy.work, b.energy.work);
  centers.check("centers");
  velocities.check("velocities");
  momenta.check("angular momenta");
  spins.check("angular velocities");
  forces.check("forces");
  energies.check("energies");
  turns.check("rotations");
  if (a.time > 0) {
    EXPECT_EQ(a.inverted, b.inverted);
  }
}

inline void compare(const SceneBodies& scene,
                    reference::ReferenceBodies& twin,
                    Simulator& simulator) {
  Comparison positions, velocities, surfaces;
  for (std::size_t b = 0; b < scene.scene.bodies.size(); ++b) {
    positions.add(twin.node_positions(b), simulator.node_positions(b));
    velocities.add(twin.node_velocities(b), simulator.node_velocities(b));
    surfaces.add(twin.surface_positions(b), simulator.surface_positions(b));
  }
  positions.check("positions");
  velocities.check("node velocities");
  surfaces.check("surfaces");
  compare_records(twin.record(), simulator.record());
}

/// Steps both, and compares them after every step until something differs.
template <class BeforeStep>
void run_both(const Scene& from, Backend backend, int steps, const BeforeStep& before_step) {
  const SceneBodies scene(from);
  auto twin = scene.bodies();
  SimulateOptions options;
  options.backend = backend;
  options.threads = 1;
  Simulator simulator(from, options);
  compare(scene, twin, simulator);
  for (int step = 0; step < steps && !testing::Test::HasFailure(); ++step) {
    SCOPED_TRACE("step " + std::to_string(step));
    before_step(step, twin);
    before_step(step, simulator);
    twin.step();
    ASSERT_TRUE(simulator.step());
    compare(scene, twin, simulator);
  }
}

}  // namespace tetwarp::test

/// @file stress_watch.hpp
/// Steps a scene and watches what must hold however hard the scene is.
#pragma once
#include <algorithm>
#include <cmath>
#include <ostream>

#include "tests/simulate/crossing.hpp"
#include "tests/simulate/law_scenes.hpp"

namespace tetwarp::test {

struct Watch {
  bool is_finite = true;
  std::int64_t crossings = 0;   ///< of triangles of different bodies, at the ends of all steps
  double least_distance = 1e9;  ///< [m]
  std::int64_t unconverged = 0, clamped = 0, stalled = 0, divided = 0, most_contacts = 0;
  double most_energy = 0;  ///< largest total energy less that of the start [J]
};

inline std::ostream& operator<<(std::ostream& out, const Watch& watch) {
  return out << watch.most_contacts << " contacts, " << watch.unconverged << " unconverged, "
             << watch.divided << " divided, " << watch.clamped << " clamped, distance "
             << watch.least_distance;
}

inline std::vector<Surface> surfaces_now(const Simulator& simulator) {
  std::vector<Surface> surfaces;
  for (std::size_t b = 0; b < simulator.scene().bodies.size(); ++b) {
    surfaces.push_back({simulator.surface_positions(b), simulator.body(b).surface.triangles});
  }
  return surfaces;
}

/// @param every  steps between looks for crossings
inline Watch watch_steps(Simulator& simulator, int steps, int every = 1) {
  Watch watch;
  const double start = simulator.record().energy.total();
  for (int n = 1; n <= steps; ++n) {
    simulator.step();
    const StepRecord& record = simulator.record();
    watch.least_distance = std::min(watch.least_distance, record.smallest_distance);
    watch.unconverged += !record.converged;
    watch.clamped += record.clamped_islands;
    watch.stalled += record.stalled_scripts;
    watch.divided += record.substeps > 1;
    watch.most_contacts = std::max(watch.most_contacts, record.contacts);
    watch.is_finite = watch.is_finite && std::isfinite(record.energy.total());
    watch.most_energy = std::max(watch.most_energy, record.energy.total() - start);
    if (n % every != 0) continue;
    const std::vector<Surface> surfaces = surfaces_now(simulator);
    for (std::size_t a = 0; a < surfaces.size(); ++a) {
      for (const Point3& x : surfaces[a].points) watch.is_finite = watch.is_finite && is_finite(x);
      for (std::size_t b = a + 1; b < surfaces.size(); ++b) {
        watch.crossings += crossing_count(surfaces[a], surfaces[b]);
      }
    }
  }
  return watch;
}

}  // namespace tetwarp::test

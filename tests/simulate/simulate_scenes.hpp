/// @file simulate_scenes.hpp
/// Small scenes for tests of models and the Simulator.
#pragma once
#include <cmath>
#include <string>
#include <tetwarp/simulate.hpp>
#include <vector>

#include "host/base/point3.hpp"
#include "host/scene/scene_geometry.hpp"
#include "host/simulate/model/model.hpp"
#include "tests/support/largest_distance.hpp"

namespace tetwarp::test {

/// An elastic box of `cells` lattice cells; damped by gamma alone.
inline Body elastic_box(const std::string& name,
                        const Point3& half,
                        const std::array<std::int64_t, 3>& cells) {
  Body body;
  body.name = name;
  body.geometry = Shape{BoxShape{half}};
  body.lattice = Lattice{.cells = cells};
  body.material = {1e5, 0.3, 1000};
  return body;
}

inline Body rigid_box(const std::string& name, const Point3& half, const Point3& position) {
  Body body;
  body.name = name;
  body.kind = BodyKind::rigid;
  body.geometry = Shape{BoxShape{half}};
  body.pose.position = position;
  return body;
}

inline Body sheet_body(const std::string& name,
                       const std::array<double, 2>& size,
                       const std::array<std::int64_t, 2>& cells) {
  Body body;
  body.name = name;
  body.kind = BodyKind::cloth;
  body.geometry = Sheet{.size = size, .cells = cells};
  return body;
}

/// Solves far below the tolerances of the tests.
inline Scene scene_of(std::vector<Body> bodies, double time_step) {
  Scene scene;
  scene.time_step = time_step;
  scene.duration = 1;
  scene.bodies = std::move(bodies);
  scene.solver.linear_tolerance = 1e-13;
  return scene;
}

inline Model model_of(const Scene& scene) {
  return make_model(scene, make_scene_geometry(scene));
}

inline double total(const std::vector<double>& list) {
  double sum = 0;
  for (const double x : list) sum += x;
  return sum;
}

inline double distance_of(const Point3& a, const Point3& b) {
  return norm(minus(a, b));
}

inline void run(Simulator& simulator, int steps) {
  for (int n = 0; n < steps; ++n) simulator.step();
}

}  // namespace tetwarp::test

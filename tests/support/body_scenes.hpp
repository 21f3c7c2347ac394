/// @file body_scenes.hpp
/// Small scenes for tests of the simulator, and the reference that steps one.
#pragma once
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <tetwarp/scene.hpp>

#include "host/reference/simulate/bodies.hpp"
#include "host/scene/scene_geometry.hpp"
#include "tests/support/largest_distance.hpp"

namespace tetwarp::test {

/// A scene of a given number of steps, its solves as exact as float64 allows.
inline Scene scene_of(double time_step, std::int64_t steps, const Point3& gravity = {0, 0, 0}) {
  Scene scene;
  scene.time_step = time_step;
  scene.duration = time_step * static_cast<double>(steps);
  scene.gravity = gravity;
  scene.solver.linear_tolerance = 1e-13;
  scene.solver.max_substeps = 1;
  return scene;
}

/// An elastic box of five tetrahedra per cell, without damping.
inline Body elastic_box(const std::string& name,
                        const Point3& half,
                        const std::array<std::int64_t, 3>& cells,
                        const Material& material) {
  Body body;
  body.name = name;
  body.kind = BodyKind::fem;
  body.geometry = Shape{BoxShape{half}};
  body.lattice = Lattice{cells, {}, {}};
  body.material = material;
  body.damping = {0, 0};
  return body;
}

inline Body rigid_box(const std::string& name, const Point3& half, double density) {
  Body body;
  body.name = name;
  body.kind = BodyKind::rigid;
  body.geometry = Shape{BoxShape{half}};
  body.rigid.density = density;
  body.damping = {0, 0};
  return body;
}

/// A sheet in the plane z = 0 from the origin on, without damping.
inline Body sheet_body(const std::string& name,
                       const std::array<double, 2>& size,
                       const std::array<std::int64_t, 2>& cells,
                       const Cloth& cloth) {
  Body body;
  body.name = name;
  body.kind = BodyKind::cloth;
  Sheet sheet;
  sheet.size = size;
  sheet.cells = cells;
  body.geometry = sheet;
  body.cloth = cloth;
  body.damping = {0, 0};
  return body;
}

/// A scene with its geometry, which tests may change before the bodies are made.
struct SceneBodies {
  Scene scene;
  SceneGeometry geometry;

  explicit SceneBodies(Scene from) : scene(std::move(from)), geometry(make_scene_geometry(scene)) {}
  SceneBodies(const SceneBodies&) = delete;
  SceneBodies& operator=(const SceneBodies&) = delete;

  reference::ReferenceBodies bodies() const { return {scene, geometry}; }
};

/// Places the nodes of a scene without rigid bodies.
inline void set_nodes(reference::ReferenceBodies& bodies,
                      const std::vector<Point3>& positions,
                      const std::vector<Point3>& velocities) {
  reference::BodiesState state = bodies.state();
  state.node_positions = positions;
  state.node_velocities = velocities;
  bodies.set_state(state);
}

/// Nodes of the geometry for which `is_chosen(position)` holds.
template <class Predicate>
std::vector<std::int32_t> nodes_where(const BodyGeometry& geometry, const Predicate& is_chosen) {
  std::vector<std::int32_t> chosen;
  for (std::size_t n = 0; n < geometry.nodes.size(); ++n) {
    if (is_chosen(geometry.nodes[n])) chosen.push_back(static_cast<std::int32_t>(n));
  }
  return chosen;
}

/// Evenly distributed numbers from -1 to 1, the same in every run.
class Noise {
 public:
  explicit Noise(std::uint64_t seed) : state_(seed) {}
  double operator()() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state_ >> 11) * 0x1p-52 - 1;
  }
  Point3 point(double size) {
    const double x = (*this)(), y = (*this)(), z = (*this)();
    return {size * x, size * y, size * z};
  }

 private:
  std::uint64_t state_;
};

}  // namespace tetwarp::test

/// @file fingerprint.cpp
/// Hashes the numbers of a scene that its steps depend on.
#include "host/simulate/run/fingerprint.hpp"

#include <algorithm>
#include <array>
#include <type_traits>
#include <variant>
#include <vector>

#include "host/base/number_hash.hpp"

namespace tetwarp {
namespace {

class Hash {
 public:
  template <class T>
  void add(const std::vector<T>& list) {
    add(static_cast<double>(list.size()));
    for (const T& item : list) add(item);
  }
  template <class T, std::size_t count>
  void add(const std::array<T, count>& list) {
    for (const T& item : list) add(item);
  }
  template <class T>
  requires std::is_arithmetic_v<T>
  void add(T number) { numbers_.add(static_cast<double>(number)); }
  void add(const ModelPoint& point) {
    add(point.body);
    add(point.node);
    add(point.weight);
    add(point.rigid);
    add(point.local);
  }
  void add(const PathPoint& point) {
    add(point.time);
    add(point.displacement.has_value());
    if (point.displacement) add(*point.displacement);
    add(point.axis_angle);
  }
  void add(const Hinge& hinge) {
    add(hinge.point);
    add(hinge.axis);
    add(hinge.angle);
  }
  void add(const Wave& wave) {
    add(wave.axis);
    add(wave.lateral);
    add(wave.frequency);
    add(wave.wavelength);
    add(wave.phase);
    add(wave.envelope);
  }
  void add(const std::monostate&) { add(0); }
  void add(const ContactMaterial& material) {
    add(material.friction);
    add(material.stiffness);
    add(material.tangential_stiffness.value_or(-1));
    add(material.energy);
    add(material.viscosity);
    add(material.bonding_rate);
    add(material.saturation_pressure);
    add(material.initial_intensity);
    add(material.restitution);
  }
  void add(const PairMaterial& pair) {
    add(pair.bodies);
    add(pair.material);
  }
  std::uint64_t value() const { return numbers_.value(); }

 private:
  NumberHash numbers_;
};

void add_scene(const Scene& scene, const SceneGeometry& geometry, Hash& hash) {
  hash.add(scene.time_step);
  hash.add(scene.gravity);
  hash.add(scene.solver.linear_tolerance);
  hash.add(scene.solver.contact_tolerance);
  hash.add(scene.solver.max_substeps);
  hash.add(scene.solver.max_passes);
  hash.add(scene.solver.pyramid);
  hash.add(scene.solver.restrictive);
  hash.add(scene.solver.sleeping);
  for (const Body& body : scene.bodies) {
    hash.add(static_cast<int>(body.kind));
    hash.add(body.motion.index());
    std::visit([&](const auto& motion) { hash.add(motion); }, body.motion);
    for (const DrivenNodes& driven : body.driven) hash.add(driven.path);
  }
  for (const BodyGeometry& body : geometry.bodies) {
    for (const DrivenGroup& group : body.driven) hash.add(group.nodes);
  }
  for (const Obstacle& obstacle : scene.obstacles) hash.add(obstacle.path);
  for (const Handle& handle : scene.handles) hash.add(handle.path);
  for (const Load& load : scene.loads) {
    hash.add(load.force.value_or(Point3{0, 0, 0}));
    hash.add(load.pressure.value_or(0));
    hash.add(load.from);
    hash.add(load.to);
    hash.add(std::ranges::find(scene.bodies, load.body, &Body::name) - scene.bodies.begin());
  }
  hash.add(geometry.load_nodes);
}

void add_options(const SimulateOptions& options, Hash& hash) {
  hash.add(options.float32_solve);
  hash.add(options.max_iterations);
  hash.add(options.untangle);
}

void add_surfaces(const SceneSurfaces& scene, Hash& hash) {
  const CollisionSurfaces& surfaces = scene.surfaces;
  hash.add(surfaces.thickness);
  for (const CollisionBody& body : surfaces.bodies) {
    hash.add(body.vertex_end);
    hash.add(body.edge_end);
    hash.add(body.triangle_end);
    hash.add(body.plane_end);
    hash.add(body.touches_itself);
  }
  hash.add(surfaces.vertex_radius);
  hash.add(surfaces.vertex_area);
  hash.add(surfaces.edge_radius);
  hash.add(surfaces.triangles);
  hash.add(surfaces.forbidden);
  hash.add(scene.vertex_point);
  for (const PlanePlace& plane : scene.plane_local) {
    hash.add(plane.point);
    hash.add(plane.normal);
  }
  hash.add(scene.materials);
  hash.add(scene.contact_class);
  hash.add(scene.class_material);
  hash.add(scene.pair_materials);
}

void add_model(const Model& model, Hash& hash) {
  hash.add(model.body_node);
  hash.add(model.body_rigid);
  hash.add(model.prescribed);
  hash.add(model.tets.nodes);
  hash.add(model.tets.gradient);
  hash.add(model.tets.lambda);
  hash.add(model.tets.mu);
  hash.add(model.tets.gamma);
  hash.add(model.edges.nodes);
  hash.add(model.edges.stiffness);
  hash.add(model.edges.rest_length);
  hash.add(model.edges.gamma);
  hash.add(model.springs.a);
  hash.add(model.springs.b);
  hash.add(model.springs.stiffness);
  hash.add(model.springs.damping);
  hash.add(model.springs.coupling);
  hash.add(model.springs.handle);
  hash.add(model.scalar_blocks.nodes);
  hash.add(model.scalar_blocks.mass);
  hash.add(model.scalar_blocks.mass_alpha);
  hash.add(model.scalar_blocks.bend);
  hash.add(model.scalar_blocks.bend_gamma);
  hash.add(model.rigid.mass);
  hash.add(model.rigid.inertia);
  hash.add(model.rigid.alpha);
  hash.add(model.rigid.centre);
  hash.add(model.start.position);
  hash.add(model.start.velocity);
  hash.add(model.start.rotation);
  hash.add(model.start.angular_momentum);
}

}  // namespace

std::uint64_t fingerprint_of(const SimulatedScene& scene) {
  Hash hash;
  add_scene(scene.scene, scene.geometry, hash);
  add_options(scene.options, hash);
  add_surfaces(scene.surfaces, hash);
  add_model(scene.model, hash);
  return hash.value();
}

}  // namespace tetwarp

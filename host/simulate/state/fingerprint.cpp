/// @file fingerprint.cpp
/// Hashes the numbers of a scene that its steps depend on.
#include "host/simulate/state/fingerprint.hpp"

#include <algorithm>
#include <array>
#include <type_traits>
#include <variant>
#include <vector>

#include "host/base/number_hash.hpp"

namespace tetwarp {
namespace {

// Structured bindings name all members of a record: with a new one this file does not compile until
// it is decided whether that is part of the fingerprint.

class Hash {
 public:
  /// Of several members, one after the other.
  template <class First, class Second, class... More>
  void add(const First& first, const Second& second, const More&... more) {
    add(first);
    add(second);
    (add(more), ...);
  }
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
    const auto& [body, node, weight, rigid, local] = point;
    add(body, node, weight, rigid, local);
  }
  void add(const PathPoint& point) {
    const auto& [time, displacement, axis_angle] = point;
    add(time, displacement.has_value());
    if (displacement) add(*displacement);
    add(axis_angle);
  }
  void add(const Hinge& hinge) {
    const auto& [point, axis, angle] = hinge;
    add(point, axis, angle);
  }
  void add(const Wave& wave) {
    const auto& [axis, lateral, frequency, wavelength, phase, envelope] = wave;
    add(axis, lateral, frequency, wavelength, phase, envelope);
  }
  void add(const std::monostate&) { add(0); }
  void add(const ContactMaterial& material) {
    const auto& [friction, stiffness, tangential_stiffness, energy, viscosity, bonding_rate,
                 saturation_pressure, initial_intensity, restitution] = material;
    add(friction, stiffness, tangential_stiffness.value_or(-1), energy, viscosity, bonding_rate,
        saturation_pressure, initial_intensity, restitution);
  }
  void add(const PairMaterial& pair) {
    const auto& [bodies, material] = pair;
    add(bodies, material);
  }
  void add(const PlanePlace& plane) {
    const auto& [point, normal] = plane;
    add(point, normal);
  }
  /// The firsts follow from the ends, the rest from the bodies of the model.
  void add(const CollisionBody& body) {
    const auto& [first_vertex, vertex_end, first_edge, edge_end, first_triangle, triangle_end,
                 first_plane, plane_end, has_unknowns, is_rigid, touches_itself] = body;
    add(vertex_end, edge_end, triangle_end, plane_end, touches_itself);
  }
  std::uint64_t value() const { return numbers_.value(); }

 private:
  NumberHash numbers_;
};

void add_solver(const SceneSolver& solver, Hash& hash) {
  const auto& [contact_tolerance, linear_tolerance, max_passes, max_substeps, pyramid, restrictive,
               sleeping] = solver;
  hash.add(linear_tolerance, contact_tolerance, max_substeps, max_passes, pyramid, restrictive,
           sleeping);
}

/// Other members are in the model and the surfaces.
void add_body(const Body& of, Hash& hash) {
  const auto& [name, kind, geometry, pose, velocity, angular_velocity, collide, self, contact,
               cage_start, lattice, surface, material, transfer, lookup, mean, mass, damping, cloth,
               rigid, motion, fixed, driven] = of;
  hash.add(static_cast<int>(kind), motion.index());
  std::visit([&](const auto& own) { hash.add(own); }, motion);
  for (const auto& [select, path] : driven) hash.add(path);
}

/// Selections are in the geometry.
void add_load(const Load& load, const std::vector<Body>& bodies, Hash& hash) {
  const auto& [body, select, force, pressure, from, to] = load;
  hash.add(force.value_or(Point3{0, 0, 0}), pressure.value_or(0), from, to);
  hash.add(std::ranges::find(bodies, body, &Body::name) - bodies.begin());
}

/// Thickness, contact and couplings are in the surfaces and the model; duration, output and cameras
/// have no effect on a step.
void add_scene(const Scene& scene, const SceneGeometry& geometry, Hash& hash) {
  const auto& [time_step, duration, gravity, thickness, bodies, obstacles, couplings, handles,
               loads, contact, solver, output, camera, cameras, notes] = scene;
  hash.add(time_step, gravity);
  add_solver(solver, hash);
  for (const Body& body : bodies) add_body(body, hash);
  for (const BodyGeometry& body : geometry.bodies) {
    for (const DrivenGroup& group : body.driven) hash.add(group.nodes);
  }
  for (const auto& [name, shape, material, path] : obstacles) hash.add(path);
  for (const auto& [name, body, select, stiffness, damping, path] : handles) hash.add(path);
  for (const Load& load : loads) add_load(load, bodies, hash);
  hash.add(geometry.load_nodes);
}

/// A simulation may go on with another back end, device, number of threads or limit of time, and
/// without skipping.
void add_options(const SimulateOptions& options, Hash& hash) {
  const auto& [backend, device, threads, float32_solve, max_iterations, max_step_seconds, skip,
               untangle, progress] = options;
  hash.add(float32_solve, max_iterations, untangle);
}

void add_surfaces(const SceneSurfaces& scene, Hash& hash) {
  const auto& [surfaces, vertex_point, surface_point, plane_rigid, plane_local, body_size,
               body_rigid, materials, contact_class, class_count, class_material, pair_materials] =
      scene;
  const auto& [bodies, vertex_body, vertex_radius, vertex_area, edges, edge_radius, vertex_is_flat,
               edge_is_flat, triangles, plane_body, forbidden, thickness] = surfaces;
  hash.add(thickness);
  for (const CollisionBody& body : bodies) hash.add(body);
  hash.add(vertex_radius, vertex_area, edge_radius, triangles, forbidden, vertex_point);
  for (const PlanePlace& plane : plane_local) hash.add(plane);
  hash.add(materials, contact_class, class_material, pair_materials);
}

void add_elements(const Model& model, Hash& hash) {
  {
    const auto& [nodes, gradient, volume, lambda, mu, gamma] = model.tets;
    hash.add(nodes, gradient, lambda, mu, gamma);
  }
  {
    const auto& [nodes, stiffness, rest_length, gamma] = model.edges;
    hash.add(nodes, stiffness, rest_length, gamma);
  }
  {
    const auto& [a, b, stiffness, damping, coupling, handle] = model.springs;
    hash.add(a, b, stiffness, damping, coupling, handle);
  }
  const auto& [nodes, mass, mass_alpha, bend, bend_gamma] = model.scalar_blocks;
  hash.add(nodes, mass, mass_alpha, bend, bend_gamma);
}

/// Members that are left out follow from the others or have no effect on a step.
void add_model(const Model& model, Hash& hash) {
  const auto& [node_count, rigid_count, body_node, body_rigid, prescribed, node_mass,
               body_foreground, body_covered, tets, edges, springs, scalar_blocks, rigid,
               body_island, island_count, start] = model;
  hash.add(body_node, body_rigid, prescribed);
  add_elements(model, hash);
  const auto& [body, mass, inertia, alpha, center, axes] = rigid;
  hash.add(mass, inertia, alpha, center);
  const auto& [position, rotation, velocity, angular_momentum] = start;
  hash.add(position, velocity, rotation, angular_momentum);
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

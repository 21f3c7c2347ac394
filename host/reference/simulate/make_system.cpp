/// @file make_system.cpp
/// Numbers nodes and frames, adds bodies, and marks what is prescribed.
#include "host/reference/simulate/make_system.hpp"

#include "host/reference/simulate/nearest_material.hpp"
#include "host/reference/simulate/prescribed.hpp"
#include "host/reference/simulate/shares.hpp"
#include "host/reference/simulate/springs.hpp"

namespace tetwarp::reference {
namespace {

bool has_nodes(const BodyGeometry& geometry) {
  return !geometry.nodes.empty();
}

void add_block(const MatrixXd& part, int first, double factor, MatrixXd& whole) {
  whole.block(first, first, part.rows(), part.cols()) += factor * part;
}

void add_fem(const Body& body, const BodyGeometry& geometry, int first, System& system) {
  const FemBody fem = fem_body(body, geometry);
  for (Element element : fem.elements) {
    for (int& node : element.nodes) node += first;
    system.elements.push_back(element);
    system.element_gamma.push_back(body.damping.gamma);
  }
  add_block(fem.mass, first, 1, system.mass);
  add_block(fem.mass, first, body.damping.alpha, system.mass_alpha);
}

void add_cloth(const Body& body, const BodyGeometry& geometry, int first, System& system) {
  const ClothBody cloth = cloth_body(body, geometry);
  for (EdgeSpring spring : cloth.springs) {
    for (int& node : spring.nodes) node += first;
    system.edges.push_back(spring);
  }
  add_block(cloth.mass, first, 1, system.mass);
  add_block(cloth.mass, first, body.damping.alpha, system.mass_alpha);
  add_block(cloth.bend, first, 1, system.bend);
  add_block(cloth.bend, first, body.damping.gamma, system.bend_gamma);
}

/// Places of all bodies; sizes the matrices.
void place_bodies(System& system) {
  int nodes = 0;
  for (std::size_t b = 0; b < system.scene.bodies.size(); ++b) {
    const BodyGeometry& geometry = system.geometry.bodies[b];
    const Body& body = system.scene.bodies[b];
    BodyPlace place{nodes, 0, -1};
    if (body.kind == BodyKind::rigid || !has_nodes(geometry)) {
      place.rigid = static_cast<int>(system.rigids.size());
      RigidBody rigid;
      if (body.kind == BodyKind::rigid) rigid = rigid_of(body, geometry.surface);
      rigid.body = static_cast<int>(b);
      system.rigids.push_back(rigid);
    } else {
      place.node_count = static_cast<int>(geometry.nodes.size());
    }
    nodes += place.node_count;
    system.places.push_back(place);
  }
  for (MatrixXd* matrix : {&system.mass, &system.mass_alpha, &system.bend, &system.bend_gamma}) {
    *matrix = MatrixXd::Zero(nodes, nodes);
  }
}

void mark_prescribed(System& system) {
  system.is_prescribed.assign(static_cast<std::size_t>(system.block_count()), false);
  const auto mark = [&](int block) {
    system.is_prescribed[static_cast<std::size_t>(block)] = true;
  };
  for (std::size_t b = 0; b < system.scene.bodies.size(); ++b) {
    const BodyGeometry& geometry = system.geometry.bodies[b];
    const BodyPlace& place = system.places[b];
    if (system.scene.bodies[b].kind == BodyKind::scripted) {
      for (int n = 0; n < place.node_count; ++n) mark(place.first_node + n);
    }
    for (const int n : geometry.fixed) mark(place.first_node + n);
    for (const DrivenGroup& group : geometry.driven) {
      for (const int n : group.nodes) mark(place.first_node + n);
    }
  }
  for (std::size_t r = 0; r < system.rigids.size(); ++r) {
    if (system.rigids[r].mass != 0) continue;
    mark(system.linear_block(static_cast<int>(r)));
    mark(system.linear_block(static_cast<int>(r)) + 1);
  }
}

/// v = velocity + angular_velocity x (position - center of mass).
void start_nodes(const System& system, std::size_t b, State& state) {
  const Body& body = system.scene.bodies[b];
  const BodyPlace& place = system.places[b];
  const VectorXd weights = system.mass.rowwise().sum();
  Vector3d center = Vector3d::Zero();
  double mass = 0;
  for (int n = place.first_node; n < place.first_node + place.node_count; ++n) {
    center += weights(n) * state.node[static_cast<std::size_t>(n)];
    mass += weights(n);
  }
  if (mass > 0) center /= mass;
  for (int n = place.first_node; n < place.first_node + place.node_count; ++n) {
    const auto node = static_cast<std::size_t>(n);
    if (system.is_prescribed[node]) continue;
    state.velocity[node] = vector_of(body.velocity) +
                           vector_of(body.angular_velocity).cross(state.node[node] - center);
  }
}

}  // namespace

System make_system(const Scene& scene, const SceneGeometry& geometry) {
  System system;
  system.scene = scene;
  system.geometry = geometry;
  place_bodies(system);
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const int first = system.places[b].first_node;
    const Body& body = scene.bodies[b];
    if (body.kind == BodyKind::fem) add_fem(body, geometry.bodies[b], first, system);
    if (body.kind == BodyKind::cloth) add_cloth(body, geometry.bodies[b], first, system);
  }
  for (std::size_t o = 0; o < scene.obstacles.size(); ++o) {
    obstacle_frame(system, static_cast<int>(o));
  }
  mark_prescribed(system);
  bind_surfaces(system);
  add_springs(start_of(system), system);
  add_loads(system);
  return system;
}

State start_of(const System& system) {
  State state;
  state.node.resize(static_cast<std::size_t>(system.node_count()));
  state.frame.resize(system.rigids.size());
  state.velocity.assign(static_cast<std::size_t>(system.block_count()), Vector3d::Zero());
  state.angular_momentum.assign(system.rigids.size(), Vector3d::Zero());
  for (std::size_t b = 0; b < system.scene.bodies.size(); ++b) {
    const Body& body = system.scene.bodies[b];
    const Placement pose = placement_of(body.pose);
    const BodyPlace& place = system.places[b];
    for (int n = 0; n < place.node_count; ++n) {
      state.node[static_cast<std::size_t>(place.first_node + n)] =
          pose(vector_of(system.geometry.bodies[b].nodes[static_cast<std::size_t>(n)]));
    }
    start_nodes(system, b, state);
    if (place.rigid < 0) continue;
    const auto r = static_cast<std::size_t>(place.rigid);
    const RigidBody& rigid = system.rigids[r];
    state.frame[r] = {pose(rigid.center), pose.rotation};
    if (rigid.mass == 0) continue;
    const auto block = static_cast<std::size_t>(system.linear_block(place.rigid));
    state.velocity[block] = vector_of(body.velocity);
    state.velocity[block + 1] = vector_of(body.angular_velocity);
    state.angular_momentum[r] = inertia_of(rigid, pose.rotation) * state.velocity[block + 1];
  }
  const Prescribed scripts = prescribed_at(system, Overrides::none_of(system.scene), 0);
  for (std::size_t n = 0; n < state.node.size(); ++n) {
    if (scripts.nodes[n]) state.node[n] = *scripts.nodes[n];
  }
  for (std::size_t r = 0; r < state.frame.size(); ++r) {
    if (scripts.frames[r]) state.frame[r] = *scripts.frames[r];
  }
  return state;
}

}  // namespace tetwarp::reference

/// @file model.cpp
/// Numbers nodes and rigid bodies, adds all bodies, and finds coupling islands.
#include <algorithm>
#include <limits>
#include <stdexcept>

#include "host/base/disjoint_sets.hpp"
#include "host/simulate/model/body_part.hpp"
#include "host/simulate/model/cloth.hpp"
#include "host/simulate/model/fem.hpp"
#include "host/simulate/model/motion.hpp"
#include "host/simulate/model/rigid.hpp"
#include "host/simulate/model/rotations.hpp"
#include "host/simulate/model/springs.hpp"

namespace tetwarp {

namespace {

/// World positions at the start: nodes stand where their body is posed, those that follow a path or
/// script where it is at time 0.
std::vector<Point3> start_positions(const Body& body, const BodyGeometry& geometry) {
  const bool is_scripted = body.kind == BodyKind::scripted;
  const Pose pose = is_scripted ? frame_at(body.motion, body.pose, 0) : body.pose;
  std::vector<Point3> positions = geometry.nodes;
  if (is_scripted) positions = WaveMotion(body.motion, geometry.nodes).points_at(0);
  for (Point3& x : positions) x = world_of(pose, x);
  for (const DrivenGroup& group : geometry.driven) {
    const Pose driven = moved(body.pose, place_at(*group.path, 0).value_or(PathPlace{}));
    for (const std::int32_t n : group.nodes) {
      positions[static_cast<std::size_t>(n)] = world_of(driven, at(geometry.nodes, n));
    }
  }
  return positions;
}

void add_nodes(const Body& body, const BodyGeometry& geometry, Model& model) {
  const auto first = static_cast<std::size_t>(model.node_count);
  const std::vector<Point3> positions = start_positions(body, geometry);
  model.start.position.insert(model.start.position.end(), positions.begin(), positions.end());
  const bool is_scripted = body.kind == BodyKind::scripted;
  model.prescribed.insert(model.prescribed.end(), positions.size(), is_scripted);
  for (const std::int32_t n : geometry.fixed) {
    model.prescribed[first + static_cast<std::size_t>(n)] = 1;
  }
  for (const DrivenGroup& group : geometry.driven) {
    for (const std::int32_t n : group.nodes) {
      model.prescribed[first + static_cast<std::size_t>(n)] = 1;
    }
  }
  model.start.velocity.insert(model.start.velocity.end(), positions.size(), Point3{0, 0, 0});
  model.node_count += static_cast<std::int32_t>(positions.size());
}

/// The start velocity of a body whose masses are known: v + omega x (x - center of mass).
void set_velocities(const BodyPart& part, Model& model) {
  const auto first = static_cast<std::size_t>(part.first_node);
  double mass = 0;
  Point3 center{0, 0, 0};
  for (std::size_t n = first; n < first + part.geometry.nodes.size(); ++n) {
    mass += model.node_mass[n];
    center = plus(center, times(model.node_mass[n], model.start.position[n]));
  }
  center = times(1 / mass, center);
  for (std::size_t n = first; n < first + part.geometry.nodes.size(); ++n) {
    if (model.prescribed[n] != 0) continue;
    const Point3 arm = minus(model.start.position[n], center);
    model.start.velocity[n] = plus(part.body.velocity, cross(part.body.angular_velocity, arm));
  }
}

void check_size(const SceneGeometry& geometry) {
  std::size_t nodes = 0, tets = 0;
  for (const BodyGeometry& body : geometry.bodies) {
    nodes += body.nodes.size() + 2;
    tets += body.tets.size();
  }
  constexpr auto most = static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()) / 4;
  if (nodes < most && tets < most) return;
  throw std::invalid_argument(
      "the scene has 2^29 or more nodes or tetrahedra; make lattices coarser");
}

/// Every obstacle has a frame: paths move it, and so may Simulator::move_script().
void add_obstacle_frames(const Scene& scene, Model& model) {
  for (std::size_t o = 0; o < scene.obstacles.size(); ++o) {
    const PathPlace place = place_at(scene.obstacles[o].path, 0).value_or(PathPlace{});
    add_frame(static_cast<std::int32_t>(scene.bodies.size() + o), moved(Pose{}, place), model);
  }
}

/// Sets body_island and island_count.
void find_islands(const Scene& scene, Model& model) {
  const std::size_t count = scene.bodies.size();
  std::vector<std::uint8_t> has_unknowns(count, 0);
  for (std::size_t b = 0; b < count; ++b) {
    for (std::int32_t n = model.body_node[b]; n < model.body_node[b + 1]; ++n) {
      if (at(model.prescribed, n) == 0) has_unknowns[b] = 1;
    }
    if (scene.bodies[b].kind == BodyKind::rigid) has_unknowns[b] = 1;
  }
  DisjointSets islands(count);
  for (std::size_t s = 0; s < model.springs.a.size(); ++s) {
    const auto a = static_cast<std::size_t>(model.springs.a[s].body);
    const auto b = static_cast<std::size_t>(model.springs.b[s].body);
    if (a >= count || b >= count || has_unknowns[a] == 0 || has_unknowns[b] == 0) continue;
    islands.unite(a, b);
  }
  model.body_island.assign(count, -1);
  for (std::size_t b = 0; b < count; ++b) {
    if (has_unknowns[b] == 0) continue;
    const std::size_t root = islands.root_of(b);
    model.body_island[b] = root == b ? model.island_count++ : model.body_island[root];
  }
}

}  // namespace

Model make_model(const Scene& scene, const SceneGeometry& geometry) {
  check_size(geometry);
  Model model;
  model.body_node.push_back(0);
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    add_nodes(scene.bodies[b], geometry.bodies[b], model);
    model.body_node.push_back(model.node_count);
  }
  model.node_mass.assign(static_cast<std::size_t>(model.node_count), 0);
  model.body_rigid.assign(scene.bodies.size(), -1);
  model.body_foreground.assign(scene.bodies.size(), 0);
  model.body_covered.assign(scene.bodies.size(), 0);
  ImageMaterialsOfBodies images;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const BodyPart part{scene.bodies[b], geometry.bodies[b], static_cast<std::int32_t>(b),
                        model.body_node[b]};
    switch (part.body.kind) {
      case BodyKind::fem:
        add_fem(part, images, model);
        set_velocities(part, model);
        break;
      case BodyKind::cloth:
        add_cloth(part, model);
        set_velocities(part, model);
        break;
      case BodyKind::rigid:
        model.body_rigid[b] = model.rigid_count;
        add_rigid(part, model);
        break;
      case BodyKind::scripted:
        if (part.geometry.nodes.empty()) {
          model.body_rigid[b] =
              add_frame(part.index, frame_at(part.body.motion, part.body.pose, 0), model);
        }
        break;
    }
  }
  add_obstacle_frames(scene, model);
  add_springs(scene, geometry, model);
  find_islands(scene, model);
  return model;
}

}  // namespace tetwarp

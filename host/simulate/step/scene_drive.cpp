/// @file scene_drive.cpp
/// Evaluates paths, scripts and handles at the end of a step.
#include "host/simulate/step/scene_drive.hpp"

#include <stdexcept>

#include "host/base/index_of.hpp"
#include "host/simulate/model/rotations.hpp"

namespace tetwarp {
namespace {

std::string list_of(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list.empty() ? "none" : list;
}

}  // namespace

SceneDrive::SceneDrive(const Scene& scene, const SceneGeometry& geometry, const Model& model)
    : scene_(scene), geometry_(geometry), model_(model) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const bool is_scripted = scene.bodies[b].kind == BodyKind::scripted;
    waves_.emplace_back(scene.bodies[b].motion,
                        is_scripted ? geometry.bodies[b].nodes : std::vector<Point3>{});
  }
  overrides_.handles.resize(scene.handles.size());
  overrides_.scripts.resize(scene.bodies.size() + scene.obstacles.size());
  for (std::size_t h = 0; h < scene.handles.size(); ++h) now_.handles.push_back(handle_at(h, 0));
  next_handles_ = now_.handles;
  now_.delays.assign(overrides_.scripts.size(), 0);
}

void SceneDrive::delay(std::span<const double> fraction, double time_step) {
  for (std::size_t b = 0; b < fraction.size(); ++b) now_.delays[b] += (1 - fraction[b]) * time_step;
}

Pose SceneDrive::frame_of(std::size_t body, double time) const {
  const bool is_body = body < scene_.bodies.size();
  const Pose start = is_body ? scene_.bodies[body].pose : Pose{};
  if (overrides_.scripts[body]) return moved(start, *overrides_.scripts[body]);
  if (is_body) return frame_at(scene_.bodies[body].motion, start, time);
  const Path& path = scene_.obstacles[body - scene_.bodies.size()].path;
  return moved(start, place_at(path, time).value_or(PathPlace{}));
}

std::vector<Point3> SceneDrive::scripted_positions(std::size_t body, double time) const {
  const double delayed = time - now_.delays[body];
  std::vector<Point3> positions = waves_[body].points_at(delayed);
  const Pose frame = frame_of(body, delayed);
  for (Point3& x : positions) x = world_of(frame, x);
  return positions;
}

std::optional<Point3> SceneDrive::handle_at(std::size_t handle, double time) const {
  if (overrides_.handles[handle]) return *overrides_.handles[handle];
  const auto place = place_at(scene_.handles[handle].path, time);
  if (!place) return std::nullopt;
  return place->displacement;
}

void SceneDrive::fill_prescribed(const ModelState& state,
                                 double end_time,
                                 double dt,
                                 StepInput& input) const {
  input.prescribed_velocity.assign(static_cast<std::size_t>(model_.block_count()), {0, 0, 0});
  const auto head_for = [&](std::int32_t node, const Point3& target) {
    input.prescribed_velocity[index_of(node)] =
        times(1 / dt, minus(target, at(state.position, node)));
  };
  for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
    const Body& body = scene_.bodies[b];
    const BodyGeometry& of = geometry_.bodies[b];
    const std::int32_t first = model_.body_node[b];
    if (body.kind == BodyKind::scripted) {
      std::int32_t node = first;
      for (const Point3& target : scripted_positions(b, end_time)) head_for(node++, target);
    }
    for (const DrivenGroup& group : of.driven) {
      const auto place = place_at(*group.path, end_time - now_.delays[b]);
      const Pose frame = moved(body.pose, place.value_or(PathPlace{}));
      for (const std::int32_t n : group.nodes) {
        head_for(first + n, world_of(frame, at(of.nodes, n)));
      }
    }
  }
  for (std::int32_t r = 0; r < model_.rigid_count; ++r) {
    const std::int32_t block = model_.node_count + 2 * r;
    if (at(model_.prescribed, block) == 0) continue;
    const std::size_t body = index_of(at(model_.rigid.body, r));
    const Pose frame = frame_of(body, end_time - now_.delays[body]);
    input.prescribed_velocity[index_of(block)] =
        times(1 / dt, minus(frame.position, at(state.position, model_.node_count + r)));
    const Quaternion turn = product(normalized(frame.rotation), conjugate(at(state.rotation, r)));
    input.prescribed_velocity[index_of(block) + 1] = times(1 / dt, axis_angle_of(turn));
  }
}

void SceneDrive::add_places(StatePlaces& places) const {
  for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
    const std::int32_t first = model_.body_node[b];
    if (scene_.bodies[b].kind == BodyKind::scripted) {
      for (std::int32_t n = first; n < model_.body_node[b + 1]; ++n) places.nodes.push_back(n);
    }
    for (const DrivenGroup& group : geometry_.bodies[b].driven) {
      for (const std::int32_t n : group.nodes) places.nodes.push_back(first + n);
    }
  }
  for (std::int32_t r = 0; r < model_.rigid_count; ++r) {
    if (at(model_.prescribed, model_.node_count + 2 * r) != 0) places.rigid.push_back(r);
  }
}

void SceneDrive::fill_anchors(double end_time, double dt, StepInput& input) {
  for (std::size_t h = 0; h < now_.handles.size(); ++h) next_handles_[h] = handle_at(h, end_time);
  const ModelSprings& springs = model_.springs;
  input.anchor.assign(springs.a.size(), {0, 0, 0});
  input.anchor_velocity.assign(springs.a.size(), {0, 0, 0});
  input.is_active.assign(springs.a.size(), 1);
  for (std::size_t s = 0; s < springs.a.size(); ++s) {
    if (springs.handle[s] < 0) continue;
    const std::size_t h = index_of(springs.handle[s]);
    input.is_active[s] = next_handles_[h].has_value();
    if (!next_handles_[h]) continue;
    input.anchor[s] = plus(springs.b[s].local, *next_handles_[h]);
    // An anchor that takes hold again has no velocity in this step.
    const Point3 before = now_.handles[h].value_or(*next_handles_[h]);
    input.anchor_velocity[s] = times(1 / dt, minus(*next_handles_[h], before));
  }
}

void SceneDrive::fill(const ModelState& state,
                      double end_time,
                      double time_step,
                      StepInput& input) {
  input.time_step = time_step;
  input.end_time = end_time;
  input.gravity = scene_.gravity;
  fill_prescribed(state, end_time, time_step, input);
  fill_anchors(end_time, time_step, input);
}

std::size_t SceneDrive::handle_named(const std::string& name) const {
  std::vector<std::string> names;
  for (std::size_t h = 0; h < scene_.handles.size(); ++h) {
    const Handle& handle = scene_.handles[h];
    names.push_back(handle.name.empty() ? handle.body : handle.name);
    if (names.back() == name) return h;
  }
  throw std::invalid_argument("there is no handle '" + name + "'; handles: " + list_of(names));
}

void SceneDrive::move_handle(const std::string& name, const Point3& displacement) {
  if (!is_finite(displacement)) {
    throw std::invalid_argument("handle '" + name + "': the displacement is not finite");
  }
  overrides_.handles[handle_named(name)].emplace(displacement);
}

void SceneDrive::release_handle(const std::string& name) {
  overrides_.handles[handle_named(name)].emplace(std::nullopt);
}

void SceneDrive::move_script(const std::string& name, const PathPlace& place) {
  if (!is_finite(place.displacement) || !is_finite(place.axis_angle)) {
    throw std::invalid_argument("script '" + name + "': the pose is not finite");
  }
  std::vector<std::string> names;
  for (std::size_t b = 0; b < overrides_.scripts.size(); ++b) {
    const bool is_body = b < scene_.bodies.size();
    if (is_body && scene_.bodies[b].kind != BodyKind::scripted) continue;
    names.push_back(is_body ? scene_.bodies[b].name
                            : scene_.obstacles[b - scene_.bodies.size()].name);
    if (names.back() != name) continue;
    overrides_.scripts[b] = place;
    return;
  }
  throw std::invalid_argument("there is no scripted body or obstacle '" + name +
                              "'; those that can be moved: " + list_of(names));
}

}  // namespace tetwarp

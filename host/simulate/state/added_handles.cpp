/// @file added_handles.cpp
/// Points near a place, and their springs.
#include "host/simulate/state/added_handles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"
#include "host/scene/checks/scene_checks.hpp"
#include "host/simulate/model/body_points.hpp"
#include "host/simulate/model/rotations.hpp"
#include "host/simulate/model/springs.hpp"
#include "host/simulate/state/simulated_scene.hpp"

namespace tetwarp {
namespace {

std::size_t own_handle_count(const SimulatedScene& scene) {
  return scene.scene.handles.size() - scene.added.size();
}

std::size_t node_count(const SimulatedScene& scene, std::size_t body) {
  return scene.geometry.bodies[body].nodes.size();
}

/// The rigid body of the model, or -1.
std::int32_t rigid_of(const SimulatedScene& scene, std::size_t body) {
  return scene.model.body_rigid[body];
}

std::vector<ModelPoint> points_of(const SimulatedScene& scene, const AddedHandle& handle) {
  const auto body = static_cast<std::int32_t>(handle.body);
  std::vector<ModelPoint> points;
  for (const std::int32_t node : handle.nodes) {
    points.push_back(selected_point(scene.model, scene.geometry, body, node));
  }
  if (rigid_of(scene, handle.body) >= 0) {
    ModelPoint& held = points.emplace_back();
    held.body = body;
    held.rigid = rigid_of(scene, handle.body);
    held.local = handle.local;
  }
  return points;
}

/// The nodes within the radius, or else the nearest one.
void hold_nodes(const SimulatedScene& scene,
                const PointHandle& handle,
                const ModelState& now,
                AddedHandle& added) {
  const std::int32_t first = scene.model.body_node[added.body];
  std::int32_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t n = 0; n < node_count(scene, added.body); ++n) {
    const auto node = static_cast<std::int32_t>(n);
    const double away = norm(minus(at(now.position, first + node), handle.center));
    if (away <= handle.radius) added.nodes.push_back(node);
    if (away < least) nearest = node;
    least = std::min(least, away);
  }
  if (added.nodes.empty()) added.nodes = {nearest};
  for (const std::int32_t node : added.nodes) {
    added.anchors.push_back(at(now.position, first + node));
  }
}

void hold_rigid(const SimulatedScene& scene,
                const PointHandle& handle,
                const ModelState& now,
                AddedHandle& added) {
  const std::int32_t rigid = rigid_of(scene, added.body);
  const Point3 arm = minus(handle.center, at(now.position, scene.model.node_count + rigid));
  added.local = rotate(conjugate(at(now.rotation, rigid)), arm);
  added.anchors = {handle.center};
}

bool is_own_name(const SimulatedScene& scene, const std::string& name) {
  const std::vector<Handle>& handles = scene.scene.handles;
  return std::any_of(
      handles.begin(), handles.begin() + static_cast<std::ptrdiff_t>(own_handle_count(scene)),
      [&](const Handle& of) { return (of.name.empty() ? of.body : of.name) == name; });
}

std::size_t movable_body(const SimulatedScene& scene, const std::string& name) {
  const std::vector<Body>& bodies = scene.scene.bodies;
  const auto found = std::ranges::find(bodies, name, &Body::name);
  if (found == bodies.end()) fail_at("handle.body", "there is no body '" + name + "'");
  if (found->kind == BodyKind::scripted) {
    fail_at("handle.body",
            "'" + name + "' is scripted: forces do not move it, expected another body");
  }
  return static_cast<std::size_t>(found - bodies.begin());
}

}  // namespace

AddedHandle make_added_handle(const SimulatedScene& scene,
                              const PointHandle& handle,
                              const ModelState& now) {
  if (scene.backend == Backend::reference) {
    fail_at("handle", "back end reference has the handles of its scene only; use back end cpu");
  }
  check_name("handle.name", handle.name);
  if (is_own_name(scene, handle.name)) {
    fail_at("handle.name", "'" + handle.name + "' is a handle of the scene; choose another name");
  }
  check_finite("handle.center", handle.center);
  check_not_negative("handle.radius", handle.radius, "m");
  check_positive("handle.stiffness", handle.stiffness, "N/m in total");
  check_not_negative("handle.damping", handle.damping, "N s/m in total");
  AddedHandle added;
  added.name = handle.name;
  added.body = movable_body(scene, handle.body);
  added.stiffness = handle.stiffness;
  added.damping = handle.damping;
  if (rigid_of(scene, added.body) >= 0) {
    hold_rigid(scene, handle, now, added);
  } else {
    hold_nodes(scene, handle, now, added);
  }
  return added;
}

bool is_of_scene(const SimulatedScene& scene, const AddedHandle& handle) {
  if (scene.backend == Backend::reference || handle.name.empty() ||
      is_own_name(scene, handle.name) || handle.body >= scene.scene.bodies.size() ||
      scene.scene.bodies[handle.body].kind == BodyKind::scripted) {
    return false;
  }
  const auto count = static_cast<std::int32_t>(node_count(scene, handle.body));
  const std::size_t points =
      rigid_of(scene, handle.body) >= 0 ? handle.nodes.size() + 1 : handle.nodes.size();
  return points > 0 && points == handle.anchors.size() &&
         std::ranges::all_of(handle.nodes, [&](std::int32_t n) { return n >= 0 && n < count; }) &&
         std::ranges::all_of(handle.anchors, [](const Point3& x) { return is_finite(x); }) &&
         is_finite(handle.local) && handle.stiffness > 0 && std::isfinite(handle.stiffness) &&
         handle.damping >= 0 && std::isfinite(handle.damping);
}

void set_added_handles(SimulatedScene& scene, const std::vector<AddedHandle>& added) {
  std::vector<Handle>& handles = scene.scene.handles;
  const std::size_t own = own_handle_count(scene);
  ModelSprings& springs = scene.model.springs;
  auto& [a, b, stiffness, damping, coupling, of_handle] = springs;
  const auto first = std::ranges::find_if(
      of_handle, [&](std::int32_t h) { return h >= static_cast<std::int32_t>(own); });
  const auto kept = static_cast<std::size_t>(first - of_handle.begin());
  a.resize(kept);
  b.resize(kept);
  stiffness.resize(kept);
  damping.resize(kept);
  coupling.resize(kept);
  of_handle.resize(kept);
  handles.resize(own);
  for (const AddedHandle& handle : added) {
    handles.push_back({.name = handle.name,
                       .body = scene.scene.bodies[handle.body].name,
                       .stiffness = handle.stiffness,
                       .damping = handle.damping});
    const std::size_t begin = b.size();
    const std::vector<ModelPoint> points = points_of(scene, handle);
    const std::vector<double> shares =
        handle.nodes.empty() ? std::vector<double>{1}
                             : shares_of(scene.geometry.bodies[handle.body], handle.nodes);
    add_handle_springs(handles.back(), static_cast<std::int32_t>(handles.size()) - 1, points,
                       shares, scene.model);
    for (std::size_t p = 0; p < handle.anchors.size(); ++p) b[begin + p].local = handle.anchors[p];
  }
  scene.added = added;
}

}  // namespace tetwarp

/// @file prescribed.cpp
/// Places of scripted nodes and frames and of the anchors of handles at a time.
#include "host/reference/simulate/prescribed.hpp"

#include <algorithm>

namespace tetwarp::reference {
namespace {

/// Extent of the nodes of a scripted body along an axis of its geometry: first, length.
std::array<double, 2> extent_of(const std::vector<Point3>& nodes, int axis) {
  const auto at = [axis](const Point3& p) { return p[static_cast<std::size_t>(axis)]; };
  const auto [low, high] = std::minmax_element(nodes.begin(), nodes.end(),
                                               [&](auto& a, auto& b) { return at(a) < at(b); });
  return {at(*low), at(*high) - at(*low)};
}

void script_nodes(const Body& body,
                  const BodyGeometry& geometry,
                  const Placement& frame,
                  int first_node,
                  double time,
                  Prescribed& prescribed) {
  const auto* wave = std::get_if<Wave>(&body.motion);
  const int axis = wave == nullptr ? 0 : wave->axis;
  const auto [low, length] = extent_of(geometry.nodes, axis);
  for (std::size_t n = 0; n < geometry.nodes.size(); ++n) {
    const Vector3d rest = vector_of(geometry.nodes[n]);
    const double s = length > 0 ? (rest(axis) - low) / length : 0;
    prescribed.nodes[static_cast<std::size_t>(first_node) + n] =
        frame(rest + wave_at(body.motion, length, s, time));
  }
}

}  // namespace

Prescribed prescribed_at(const System& system, const Overrides& overrides, double end_time) {
  const Scene& scene = system.scene;
  Prescribed result;
  result.nodes.resize(static_cast<std::size_t>(system.node_count()));
  result.frames.resize(system.rigids.size());
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    const BodyGeometry& geometry = system.geometry.bodies[b];
    const BodyPlace& place = system.places[b];
    const Placement start = placement_of(body.pose);
    const double time = end_time - overrides.delay[b];
    const auto node_at = [&](int n) -> std::optional<Vector3d>& {
      return result.nodes[static_cast<std::size_t>(place.first_node + n)];
    };
    const auto rest = [&](int n) { return vector_of(geometry.nodes[static_cast<std::size_t>(n)]); };
    if (body.kind == BodyKind::scripted) {
      const auto& override_of_body = overrides.bodies[b];
      const Placement frame =
          override_of_body ? moved(start, *override_of_body) : frame_at(body.motion, start, time);
      if (place.rigid >= 0) result.frames[static_cast<std::size_t>(place.rigid)] = frame;
      if (place.node_count > 0) {
        script_nodes(body, geometry, frame, place.first_node, time, result);
      }
    }
    for (const DrivenGroup& group : geometry.driven) {
      const Placement frame = moved(start, path_at(*group.path, time).value_or(PathPlace{}));
      for (const int n : group.nodes) node_at(n) = frame(rest(n));
    }
  }
  for (std::size_t r = 0; r < system.rigids.size(); ++r) {
    const int obstacle = system.rigids[r].body - static_cast<int>(scene.bodies.size());
    if (obstacle < 0) continue;
    const std::size_t of = scene.bodies.size() + static_cast<std::size_t>(obstacle);
    const auto& override_of_obstacle = overrides.bodies[of];
    const auto place = override_of_obstacle
                           ? override_of_obstacle
                           : path_at(scene.obstacles[static_cast<std::size_t>(obstacle)].path,
                                     end_time - overrides.delay[of]);
    result.frames[r] = moved(Placement{}, place.value_or(PathPlace{}));
  }
  for (std::size_t h = 0; h < scene.handles.size(); ++h) {
    const auto& moved_handle = overrides.handles[h];
    std::optional<Vector3d> displacement;
    if (moved_handle) {
      if (!moved_handle->is_released) displacement = moved_handle->displacement;
    } else if (const auto place = path_at(scene.handles[h].path, end_time)) {
      displacement = place->displacement;
    }
    result.handles.push_back(displacement);
  }
  return result;
}

}  // namespace tetwarp::reference

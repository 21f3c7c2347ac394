/// @file scene_sharer.cpp
/// Bindings of surfaces, poses of rigid bodies.
#include "host/view/screens/scene_sharer.hpp"

#include <algorithm>

#include "host/base/point3.hpp"

namespace tetwarp::view {
namespace {
Float3 narrow(const Point3& x) {
  return {static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2])};
}

std::vector<Float3> narrow(const std::vector<Point3>& points) {
  std::vector<Float3> all;
  all.reserve(points.size());
  for (const Point3& x : points) all.push_back(narrow(x));
  return all;
}

/// Origin and unit axes of a frame that three points give.
std::array<Point3, 4> frame_of(const Point3& a, const Point3& b, const Point3& c) {
  const Point3 x = unit(minus(b, a)), z = unit(cross(x, minus(c, a)));
  return {a, x, cross(z, x), z};
}

/// The point of the largest value of a measure.
template <class Measure>
std::size_t largest(const std::vector<Point3>& points, const Measure& measure) {
  const auto most = std::ranges::max_element(points, {}, measure);
  return static_cast<std::size_t>(most - points.begin());
}

void bind_surface(BoundPoints bound, SharedBody& body) {
  body.form = BodyForm::nodes;
  body.nodes = std::move(bound.nodes);
  body.weights = std::move(bound.weights);
}
}  // namespace

SceneSharer::SceneSharer(const LiveSimulation& simulation,
                         const ViewScene& scene,
                         const ViewOptions& options) {
  const Simulator& simulator = simulation.simulator();
  scene_.name = scene.name;
  scene_.preset = options.preset;
  scene_.center = scene.center;
  scene_.size = scene.size;
  scene_.voxels = options.voxels;
  scene_.obstacles = scene.obstacles;
  for (std::size_t b = 0; b < scene.triangles.size(); ++b) {
    const BodyMesh& mesh = simulator.body(b);
    const std::vector<Point3>& points = mesh.surface.points;
    SharedBody& body = scene_.bodies.emplace_back();
    auto& triad = triads_.emplace_back();
    body.triangles = scene.triangles[b];
    if (!mesh.mesh.tets.empty()) {
      body.moving_count = static_cast<std::int64_t>(mesh.mesh.rest_positions.size());
      bind_surface(simulation.looks().binding(b), body);
    } else if (mesh.kind == BodyKind::rigid && points.size() >= 3) {
      const Point3 first = points[0];
      const std::size_t second =
          largest(points, [&](const Point3& x) { return norm(minus(x, first)); });
      const Point3 x = unit(minus(points[second], first));
      const std::size_t third =
          largest(points, [&](const Point3& p) { return norm(cross(x, minus(p, first))); });
      triad = Triad{0, second, third};
      const auto [origin, ax, ay, az] = frame_of(first, points[second], points[third]);
      for (const Point3& p : points) {
        const Point3 arm = minus(p, origin);
        body.rest_points.push_back({dot(arm, ax), dot(arm, ay), dot(arm, az)});
      }
      body.form = BodyForm::pose;
      body.moving_count = 4;
    } else {
      body.moving_count = static_cast<std::int64_t>(points.size());
    }
  }
  for (const RestVolume& source : simulation.volumes().sources()) {
    scene_.volumes.push_back({source, simulator.body(source.body.body).mesh});
  }
}

SharedState SceneSharer::state(const Simulator& simulator, const LiveFrame& frame) const {
  SharedState state;
  state.step = simulator.step_index();
  state.time = simulator.time();
  state.is_paused = frame.is_paused;
  for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
    if (scene_.bodies[b].form == BodyForm::nodes) {
      state.moving.push_back(narrow(simulator.node_positions(b)));
      continue;
    }
    const std::vector<Point3> points = simulator.surface_positions(b);
    if (!triads_[b]) {
      state.moving.push_back(narrow(points));
      continue;
    }
    const auto& [p, q, r] = *triads_[b];
    const auto pose = frame_of(points[p], points[q], points[r]);
    state.moving.push_back(narrow(std::vector<Point3>(pose.begin(), pose.end())));
  }
  for (const ContactArrow& contact : frame.contacts) {
    state.contacts.push_back({narrow(contact.position), narrow(contact.force)});
  }
  state.quantity = frame.quantity;
  state.range = {static_cast<float>(frame.range.low()), static_cast<float>(frame.range.high())};
  state.levels = levels_of(frame.values, frame.range);
  if (frame.grab) state.grab = {narrow(frame.grab->point), narrow(frame.grab->target)};
  return state;
}

}  // namespace tetwarp::view

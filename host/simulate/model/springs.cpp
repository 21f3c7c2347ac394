/// @file springs.cpp
/// Pairs of points of couplings and handles, and their shares of the stiffness.
#include "host/simulate/model/springs.hpp"

#include <numeric>
#include <stdexcept>

#include "host/base/point3.hpp"
#include "host/scene/checks/scene_checks.hpp"
#include "host/simulate/model/body_points.hpp"
#include "host/simulate/model/material_finder.hpp"

namespace tetwarp {
namespace {

/// Springs of one coupling or handle, before its totals are divided among them.
struct SpringList {
  std::vector<ModelPoint> a, b;
  std::vector<double> share;
};

void add_list(const SpringList& list,
              double stiffness,
              double damping,
              std::int32_t coupling,
              std::int32_t handle,
              ModelSprings& springs) {
  const double sum = std::accumulate(list.share.begin(), list.share.end(), 0.0);
  for (std::size_t s = 0; s < list.a.size(); ++s) {
    const double share = sum > 0 ? list.share[s] / sum : 1.0 / static_cast<double>(list.a.size());
    springs.a.push_back(list.a[s]);
    springs.b.push_back(list.b[s]);
    springs.stiffness.push_back(stiffness * share);
    springs.damping.push_back(damping * share);
    springs.coupling.push_back(coupling);
    springs.handle.push_back(handle);
  }
}

// Times the size of a body: points up to so far outside are tied to it.
constexpr double most_outside = 0.05;

/// Whether a body is elastic or cloth. Points of other bodies are tied where they are, however far
/// from the body.
bool gives_way(const Scene& scene, std::int32_t body) {
  const auto index = static_cast<std::size_t>(body);
  if (body < 0 || index >= scene.bodies.size()) return false;
  return scene.bodies[index].kind == BodyKind::fem || scene.bodies[index].kind == BodyKind::cloth;
}

/// How far outside of an elastic body or cloth a point of a coupling may be [m].
double reach_of(const Coupling& coupling, const BodyGeometry& body) {
  if (coupling.within) return *coupling.within;
  const Bounds bounds = bounds_of(body.nodes);
  return most_outside * norm(minus(bounds.high, bounds.low));
}

std::int32_t body_named(const Scene& scene, const std::string& name, const std::string& where) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (scene.bodies[b].name == name) return static_cast<std::int32_t>(b);
  }
  throw std::invalid_argument(where + ": there is no body \"" + name + "\"");
}

SpringList coupling_springs(const Scene& scene,
                            const SceneGeometry& geometry,
                            std::size_t c,
                            const Model& model,
                            MaterialFinder& finder) {
  const Coupling& coupling = scene.couplings[c];
  const std::string where = "couplings[" + std::to_string(c) + "]";
  if (coupling.a == coupling.b) {
    throw std::invalid_argument(where + ": couples body \"" + coupling.a + "\" to itself");
  }
  SpringList list;
  for (std::size_t p = 0; p < coupling.points.size(); ++p) {
    const Point3& x = coupling.points[p];
    const auto tied = [&](const std::string& body) {
      const NearestMaterial found = finder.nearest(body, x);
      if (!gives_way(scene, found.point.body)) return finder.fixed_at(body, x);
      const auto index = static_cast<std::size_t>(found.point.body);
      if (found.distance <= reach_of(coupling, geometry.bodies[index])) return found.point;
      throw std::invalid_argument(where + ".points[" + std::to_string(p) + "]: is " +
                                  number_text(found.distance) + " m outside body \"" + body +
                                  "\"; move it to the body, or say how far it may be by within");
    };
    list.a.push_back(tied(coupling.a));
    list.b.push_back(tied(coupling.b));
    list.share.push_back(1);
  }
  if (!coupling.points.empty()) return list;
  const std::int32_t a = body_named(scene, coupling.a, where + ".a");
  const auto& nodes = geometry.coupling_nodes[c];
  const std::vector<double> shares = shares_of(geometry.bodies[static_cast<std::size_t>(a)], nodes);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const ModelPoint point = selected_point(model, geometry, a, nodes[i]);
    const NearestMaterial found =
        finder.nearest(coupling.b, position_of(point, model.start, model.node_count));
    if (coupling.within && found.distance > *coupling.within) continue;
    list.a.push_back(point);
    list.b.push_back(found.point);
    list.share.push_back(shares[i]);
  }
  if (list.a.empty()) {
    throw std::invalid_argument(where + ".within: none of the " + std::to_string(nodes.size()) +
                                " selected points of \"" + coupling.a + "\" is within " +
                                std::to_string(*coupling.within) + " m of \"" + coupling.b +
                                "\"; raise it");
  }
  return list;
}

}  // namespace

void add_handle_springs(const Handle& handle,
                        std::int32_t index,
                        const std::vector<ModelPoint>& points,
                        const std::vector<double>& shares,
                        Model& model) {
  SpringList list{points, {}, shares};
  for (const ModelPoint& point : points) {
    ModelPoint anchor;
    anchor.local = position_of(point, model.start, model.node_count);
    list.b.push_back(anchor);
  }
  add_list(list, handle.stiffness, handle.damping, -1, index, model.springs);
}

void add_springs(const Scene& scene, const SceneGeometry& geometry, Model& model) {
  MaterialFinder finder(scene, geometry, model);
  for (std::size_t c = 0; c < scene.couplings.size(); ++c) {
    const Coupling& coupling = scene.couplings[c];
    add_list(coupling_springs(scene, geometry, c, model, finder), coupling.stiffness,
             coupling.damping, static_cast<std::int32_t>(c), -1, model.springs);
  }
  for (std::size_t h = 0; h < scene.handles.size(); ++h) {
    const Handle& handle = scene.handles[h];
    const std::int32_t body =
        body_named(scene, handle.body, "handles[" + std::to_string(h) + "].handle");
    const auto& nodes = geometry.handle_nodes[h];
    std::vector<ModelPoint> points;
    for (const std::int32_t node : nodes) {
      points.push_back(selected_point(model, geometry, body, node));
    }
    add_handle_springs(handle, static_cast<std::int32_t>(h), points,
                       shares_of(geometry.bodies[static_cast<std::size_t>(body)], nodes), model);
  }
}

}  // namespace tetwarp

/// @file scene_geometry.cpp
/// Makes the geometry of all bodies, and selects their points.
#include "host/scene/scene_geometry.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <variant>

#include "host/scene/alike_bodies.hpp"
#include "host/scene/body_geometry.hpp"
#include "host/scene/checks/scene_checks.hpp"
#include "host/scene/pose.hpp"
#include "host/scene/selection.hpp"

namespace tetwarp {
namespace {
void refuse_overlap(const std::string& place,
                    const std::vector<std::int32_t>& nodes,
                    const std::vector<std::int32_t>& taken) {
  std::vector<std::int32_t> both;
  std::set_intersection(nodes.begin(), nodes.end(), taken.begin(), taken.end(),
                        std::back_inserter(both));
  if (both.empty()) return;
  fail_at(place, "selects " + std::to_string(both.size()) +
                     " nodes that are already fixed or driven, the first is node " +
                     std::to_string(both.front()) + "; keep the selections apart");
}

/// Whether a body keeps points within its faces: where the scene may select them, where a wave
/// bends the faces, and where the body adheres, since points that touch have the area of adhesion.
Faces faces_of(const Scene& scene, const Body& body) {
  const auto any = [](const auto& list, const auto& test) {
    return std::any_of(list.begin(), list.end(), test);
  };
  const SurfaceContact contact = body.contact.value_or(scene.contact.material);
  const bool adheres =
      contact.adhesion.has_value() ||
      any(scene.contact.pairs, [&](const ContactPairMaterial& pair) {
        return pair.adhesion.has_value() && (pair.a == body.name || pair.b == body.name);
      });
  const bool selects =
      any(scene.couplings,
          [&](const Coupling& of) { return of.a == body.name && of.points.empty(); }) ||
      any(scene.handles, [&](const Handle& of) { return of.body == body.name; }) ||
      any(scene.loads, [&](const Load& of) { return of.body == body.name; });
  return adheres || selects || std::holds_alternative<Wave>(body.motion) ? Faces::divided
                                                                         : Faces::whole;
}

/// The parts of body b; those of an earlier body that is alike are copied, as images take long.
BodyParts parts_of(const Scene& scene, std::size_t b, const std::vector<BodyParts>& before) {
  for (std::size_t other = 0; other < b; ++other) {
    if (!are_alike(scene.bodies[other], scene.bodies[b])) continue;
    BodyParts parts = before[other];
    parts.geometry.fixed.clear();
    parts.geometry.driven.clear();
    return parts;
  }
  return make_body_parts(item_of("bodies", b), scene.bodies[b], faces_of(scene, scene.bodies[b]));
}

void select_supports(const std::string& place, const Body& body, BodyParts& parts) {
  BodyGeometry& geometry = parts.geometry;
  if (!body.fixed.empty()) {
    geometry.fixed = select(key_of(place, "fixed"), body.fixed, body, parts, Selectable::nodes);
  }
  std::vector<std::int32_t> taken = geometry.fixed;
  for (std::size_t d = 0; d < body.driven.size(); ++d) {
    const std::string key = key_of(item_of(key_of(place, "driven"), d), "select");
    auto nodes = select(key, body.driven[d].select, body, parts, Selectable::nodes);
    refuse_overlap(key, nodes, taken);
    std::vector<std::int32_t> sum;
    std::merge(taken.begin(), taken.end(), nodes.begin(), nodes.end(), std::back_inserter(sum));
    taken = std::move(sum);
    geometry.driven.push_back({std::move(nodes), &body.driven[d].path});
  }
}
}  // namespace

Point3 world_of(const Pose& pose, const Point3& point) {
  return plus(pose.position, times(rotation_of(pose.rotation), point));
}

SceneGeometry make_scene_geometry(const Scene& scene) {
  std::vector<BodyParts> parts;
  std::map<std::string, std::size_t> index;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const std::string place = item_of("bodies", b);
    parts.push_back(parts_of(scene, b, parts));
    select_supports(place, scene.bodies[b], parts.back());
    index.emplace(scene.bodies[b].name, b);
  }
  const auto select_of = [&](const std::string& place, const std::string& key,
                             const std::string& body, const Selection& selection, Selectable from) {
    const auto found = index.find(body);
    if (found == index.end()) fail_at(place, "there is no body '" + body + "'");
    return select(key_of(place, key), selection, scene.bodies[found->second], parts[found->second],
                  from);
  };

  SceneGeometry geometry;
  for (std::size_t c = 0; c < scene.couplings.size(); ++c) {
    const Coupling& coupling = scene.couplings[c];
    auto& nodes = geometry.coupling_nodes.emplace_back();
    if (!coupling.points.empty()) continue;
    nodes = select_of(item_of("couplings", c), "select_a", coupling.a, coupling.select_a,
                      Selectable::nodes);
  }
  for (std::size_t h = 0; h < scene.handles.size(); ++h) {
    const Handle& handle = scene.handles[h];
    geometry.handle_nodes.push_back(
        select_of(item_of("handles", h), "select", handle.body, handle.select, Selectable::nodes));
  }
  for (std::size_t l = 0; l < scene.loads.size(); ++l) {
    const Load& load = scene.loads[l];
    geometry.load_nodes.push_back(
        select_of(item_of("loads", l), "select", load.body, load.select,
                  load.pressure ? Selectable::surface_points : Selectable::nodes));
  }
  for (BodyParts& body : parts) geometry.bodies.push_back(std::move(body.geometry));
  return geometry;
}

}  // namespace tetwarp

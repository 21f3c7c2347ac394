/// @file prepare_start.cpp
/// Chooses how a scene starts, and moves the anchors of its handles along.
#include "host/simulate/start/prepare_start.hpp"

#include <algorithm>
#include <stdexcept>

#include "host/base/point3.hpp"
#include "host/simulate/model/body_points.hpp"
#include "host/simulate/start/cage_growth.hpp"
#include "host/simulate/start/start_check.hpp"
#include "host/simulate/start/start_push.hpp"
#include "host/simulate/surfaces/round_shape.hpp"
#include "host/simulate/surfaces/surface_motion.hpp"

namespace tetwarp {
namespace {

/// Moves the anchors of handles to the starts of their points.
/// @param has_moved  [bodies]
void move_anchors(const std::vector<std::uint8_t>& has_moved, Model& model) {
  for (std::size_t s = 0; s < model.springs.a.size(); ++s) {
    if (model.springs.handle[s] < 0 || at(has_moved, model.springs.a[s].body) == 0) continue;
    model.springs.b[s].local = position_of(model.springs.a[s], model.start, model.node_count);
  }
}

void start_by_cages(const StartParts& parts, Model& model) {
  const std::vector<Body>& bodies = parts.scene.bodies;
  std::vector<std::uint8_t> has_cage(bodies.size(), 0);
  for (std::size_t b = 0; b < bodies.size(); ++b) has_cage[b] = bodies[b].cage_start;
  if (std::count(has_cage.begin(), has_cage.end(), 1) == 0) return;
  const std::vector<ShrunkBody> shrunk = shrink_apart(parts, has_cage, "cage_start", model);
  for (const ShrunkBody& body : shrunk) {
    if (parts.geometry.bodies[static_cast<std::size_t>(body.body)].driven.empty()) continue;
    throw std::invalid_argument(place_of_body(parts.scene, body.body) +
                                ": cage_start would move its driven nodes away from their path; "
                                "move it apart from others, or drive none of its nodes");
  }
  grow_by_cages(parts, shrunk, model);
  std::vector<std::uint8_t> has_moved(bodies.size(), 0);
  for (const ShrunkBody& body : shrunk) has_moved[static_cast<std::size_t>(body.body)] = 1;
  move_anchors(has_moved, model);
}

RestGrowth start_untangled(const StartParts& parts, Model& model) {
  const std::vector<Body>& bodies = parts.scene.bodies;
  std::vector<std::uint8_t> may_shrink(bodies.size(), 0);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const bool has_nodes = bodies[b].kind == BodyKind::fem || bodies[b].kind == BodyKind::cloth;
    may_shrink[b] = has_nodes && !bodies[b].cage_start;
  }
  const std::vector<Point3> full_start = model.start.position;
  const std::vector<ShrunkBody> shrunk = shrink_apart(parts, may_shrink, "untangle", model);
  return {parts.geometry, model, full_start, shrunk};
}

}  // namespace

RestGrowth prepare_start(const StartParts& parts, bool untangle, Model& model) {
  start_by_cages(parts, model);
  RestGrowth growth;
  if (untangle) growth = start_untangled(parts, model);
  SurfacePlaces places;
  surface_places(parts.surfaces, model, model.start, parts.threads, places);
  if (check_start(parts.scene, parts.surfaces, places, parts.detector, parts.threads)) {
    move_anchors(push_apart(parts, model), model);
  }
  return growth;
}

}  // namespace tetwarp

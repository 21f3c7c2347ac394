/// @file start_shrink.cpp
/// Shrinks the bodies of all pairs in conflict, step by step.
#include "host/simulate/start/start_shrink.hpp"

#include <map>
#include <stdexcept>
#include <utility>

#include "host/base/point3.hpp"
#include "host/simulate/start/medial_node.hpp"
#include "host/simulate/start/start_check.hpp"
#include "host/simulate/surfaces/round_shape.hpp"
#include "host/simulate/surfaces/surface_motion.hpp"

namespace tetwarp {
namespace {

constexpr double factor = 0.9;
constexpr double least_scale = 1.0 / 30;

class ShrinkingBodies {
 public:
  ShrinkingBodies(const StartParts& parts, Model& model)
      : parts_(parts), model_(model), start_(model.start.position) {}

  /// @param others  bodies in conflict with it that do not shrink
  /// @returns false if the body has the smallest allowed size
  bool shrink(std::int32_t body,
              const std::vector<std::int32_t>& others,
              const SurfacePlaces& places) {
    const auto [entry, is_new] = bodies_.emplace(body, ShrunkBody{body, {0, 0, 0}, 1});
    ShrunkBody& shrunk = entry->second;
    if (is_new) shrunk.center = medial_node(parts_, places, nodes_of(body), body, others);
    if (shrunk.scale * factor < least_scale) return false;
    shrunk.scale *= factor;
    for (std::int32_t n = first(body); n < first(body + 1); ++n) {
      model_.start.position[static_cast<std::size_t>(n)] =
          plus(shrunk.center, times(shrunk.scale, minus(at(start_, n), shrunk.center)));
    }
    return true;
  }

  bool has(std::int32_t body) const { return bodies_.contains(body); }
  std::vector<ShrunkBody> list() const {
    std::vector<ShrunkBody> result;
    for (const auto& [body, shrunk] : bodies_) result.push_back(shrunk);
    return result;
  }

 private:
  std::vector<Point3> nodes_of(std::int32_t body) const {
    return {start_.begin() + first(body), start_.begin() + first(body + 1)};
  }
  std::int32_t first(std::int32_t body) const { return at(model_.body_node, body); }

  const StartParts& parts_;
  Model& model_;
  std::vector<Point3> start_;  ///< positions before any body shrinks
  std::map<std::int32_t, ShrunkBody> bodies_;
};

}  // namespace

std::vector<ShrunkBody> shrink_apart(const StartParts& parts,
                                     const std::vector<std::uint8_t>& may_shrink,
                                     const std::string& what,
                                     Model& model) {
  ShrinkingBodies bodies(parts, model);
  const auto can_shrink = [&](std::int32_t body) {
    const auto index = static_cast<std::size_t>(body);
    return index < may_shrink.size() && may_shrink[index] != 0;
  };
  SurfacePlaces places;
  for (;;) {
    surface_places(parts.surfaces, model, model.start, parts.threads, places);
    std::map<std::int32_t, std::vector<std::int32_t>> shrinking;  // and those that do not
    std::vector<StartConflict> pairs;
    for (const StartConflict& conflict :
         start_conflicts(parts.surfaces, places, parts.detector, parts.threads)) {
      const auto [a, b] = conflict.bodies;
      if (!can_shrink(a) && !can_shrink(b)) continue;
      const bool has_shrunk = a != b && (bodies.has(a) || bodies.has(b));
      if (!conflict.is_intersection() && !has_shrunk) continue;
      if (a == b) {
        throw std::invalid_argument(place_of_body(parts.scene, a) +
                                    ": it intersects itself at the start, which " + what +
                                    " cannot change; set its self to false or change its shape");
      }
      pairs.push_back(conflict);
      for (const auto& [body, other] : {std::pair(a, b), std::pair(b, a)}) {
        if (!can_shrink(body)) continue;
        auto& others = shrinking[body];
        if (!can_shrink(other)) others.push_back(other);
      }
    }
    if (pairs.empty()) return bodies.list();
    bool has_changed = false;
    for (const auto& [body, others] : shrinking) {
      has_changed = bodies.shrink(body, others, places) || has_changed;
    }
    if (has_changed) continue;
    throw std::invalid_argument(place_of_body(parts.scene, pairs.front().bodies[0]) + " and " +
                                place_of_body(parts.scene, pairs.front().bodies[1]) +
                                " overlap so far that " + what +
                                " cannot bring them apart; move them apart");
  }
}

}  // namespace tetwarp

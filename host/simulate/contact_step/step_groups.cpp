/// @file step_groups.cpp
/// Joins bodies that must stop together, and finds the fraction of the step that each moves.
#include "host/simulate/contact_step/step_groups.hpp"

#include <algorithm>

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"
#include "host/collide/pair_bodies.hpp"

namespace tetwarp {
namespace {

// Then bodies that still hit stop where they started, so that the rounds end. A motion that was
// shortened in all rounds is 0.9^16 = 0.19 of the step at most.
constexpr int shortening_rounds = 16;
constexpr double kept_share = 0.9;  // of the way to a hit: all of it would be found to hit again
// A pair of a turning body may be too near at once, because its path is not straight; by how much
// the path bends falls with the square of the fraction.
constexpr double share_at_once = 0.25;

/// Bodies and obstacles, joined where springs couple two of them.
DisjointSets coupling_islands(const Model& model, std::size_t count) {
  DisjointSets sets(count);
  std::vector<std::int32_t> first(index_of(model.island_count), -1);
  for (std::size_t b = 0; b < model.body_island.size(); ++b) {
    if (model.body_island[b] < 0) continue;
    std::int32_t& of_island = first[index_of(model.body_island[b])];
    if (of_island < 0) of_island = static_cast<std::int32_t>(b);
    sets.unite(index_of(of_island), b);
  }
  return sets;
}

}  // namespace

StepGroups::StepGroups(const Model& model, const CollisionSurfaces& surfaces)
    : model_(model),
      surfaces_(surfaces),
      coupling_islands_(coupling_islands(model, surfaces.bodies.size())),
      groups_(coupling_islands_),
      fraction_(surfaces.bodies.size(), 1),
      moves_(surfaces.bodies.size(), 1) {}

void StepGroups::begin(const std::vector<TrackedContact>& contacts,
                       std::span<const BodyLink> sleeping) {
  groups_ = coupling_islands_;
  std::fill(fraction_.begin(), fraction_.end(), 1);
  rounds_ = 0;
  const auto tie = [&](std::int32_t a, std::int32_t b) {
    if (model_.island_of(a) < 0 || model_.island_of(b) < 0) return;
    groups_.unite(index_of(a), index_of(b));
  };
  for (const TrackedContact& contact : contacts) tie(contact.key.body_a, contact.key.body_b);
  for (const auto& [a, b] : sleeping) tie(a, b);
}

void StepGroups::note_what_moves(const SurfaceMotion& motion) {
  const auto vertex_moves = [&](std::int32_t v) {
    return at(motion.start.vertices, v) != at(motion.end.vertices, v) || at(motion.sagitta, v) > 0;
  };
  const auto plane_moves = [&](std::int32_t p) {
    const PlanePlace &start = at(motion.start.planes, p), &end = at(motion.end.planes, p);
    return start.point != end.point || start.normal != end.normal;
  };
  for (std::size_t b = 0; b < surfaces_.bodies.size(); ++b) {
    const CollisionBody& body = surfaces_.bodies[b];
    bool moves = false;
    for (auto v = body.first_vertex; v < body.vertex_end && !moves; ++v) moves = vertex_moves(v);
    for (auto p = body.first_plane; p < body.plane_end && !moves; ++p) moves = plane_moves(p);
    moves_[b] = moves;
  }
}

bool StepGroups::stop(const std::vector<TouchingPair>& hits, const SurfaceMotion& motion) {
  if (hits.empty()) return false;
  if (rounds_ == 0) note_what_moves(motion);
  next_ = fraction_;
  bool has_changed = false;
  for (const TouchingPair& hit : hits) has_changed = shorten(hit) || has_changed;
  share_in_groups();
  ++rounds_;
  return has_changed;
}

bool StepGroups::can_move(std::int32_t body) const {
  return at(moves_, body) != 0 && at(fraction_, body) > 0;
}

/// Shortens the next motion of the bodies of a hit that move, and joins them if both do.
/// @returns whether one moves
bool StepGroups::shorten(const TouchingPair& hit) {
  const auto bodies = bodies_of(hit, surfaces_);
  const std::array<bool, 2> moves{can_move(bodies[0]), can_move(bodies[1])};
  double left = 1;
  for (std::size_t side = 0; side < 2; ++side) {
    if (moves[side]) left = std::min(left, at(fraction_, bodies[side]));
  }
  const double share = hit.time > 0 ? kept_share * std::min(hit.time, 1.0) : share_at_once;
  left *= rounds_ < shortening_rounds ? share : 0;
  for (std::size_t side = 0; side < 2; ++side) {
    double& next = next_[index_of(bodies[side])];
    if (moves[side]) next = std::min(next, left);
  }
  if (moves[0] && moves[1]) groups_.unite(index_of(bodies[0]), index_of(bodies[1]));
  return moves[0] || moves[1];
}

/// All bodies of a group move the smallest of their next fractions.
void StepGroups::share_in_groups() {
  for (std::size_t b = 0; b < next_.size(); ++b) {
    double& of_group = next_[groups_.root_of(b)];
    of_group = std::min(of_group, next_[b]);
  }
  for (std::size_t b = 0; b < next_.size(); ++b) fraction_[b] = next_[groups_.root_of(b)];
}

double StepGroups::smallest_fraction() const {
  return fraction_.empty() ? 1 : *std::min_element(fraction_.begin(), fraction_.end());
}

std::int64_t StepGroups::islands_with_unknowns(bool only_stopped) {
  std::vector<std::size_t> roots;
  for (std::size_t b = 0; b < model_.body_island.size(); ++b) {
    if (model_.body_island[b] < 0 || (only_stopped && fraction_[b] == 1)) continue;
    roots.push_back(groups_.root_of(b));
  }
  std::sort(roots.begin(), roots.end());
  return std::unique(roots.begin(), roots.end()) - roots.begin();
}

std::int64_t StepGroups::island_count() {
  return islands_with_unknowns(false);
}
std::int64_t StepGroups::stopped_islands() {
  return islands_with_unknowns(true);
}

}  // namespace tetwarp

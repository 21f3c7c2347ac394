#include "host/simulate/run/step_groups.hpp"

#include <algorithm>

#include "host/base/point3.hpp"
#include "host/collide/pair_bodies.hpp"

namespace tetwarp {
namespace {

constexpr int shortening_rounds = 16;
constexpr double kept_share = 0.9;  // of the way to a hit
// A pair of a turning body may count as near at its start, because its way is not straight; that
// share falls with the square of the fraction.
constexpr double share_at_once = 0.25;

}  // namespace

StepGroups::StepGroups(const Model& model, const CollisionSurfaces& surfaces)
    : model_(model), surfaces_(surfaces) {
  std::vector<std::int32_t> first(static_cast<std::size_t>(model.island_count), -1);
  for (std::size_t b = 0; b < surfaces.bodies.size(); ++b) {
    const auto body = static_cast<std::int32_t>(b);
    const std::int32_t island = b < model.body_island.size() ? model.body_island[b] : -1;
    island_start_.push_back(body);
    if (island < 0) continue;
    auto& start = first[static_cast<std::size_t>(island)];
    if (start < 0) start = body;
    island_start_.back() = start;
  }
  parent_ = island_start_;
  fraction_.assign(parent_.size(), 1);
  moves_.assign(parent_.size(), 1);
}

std::int32_t StepGroups::root_of(std::int32_t body) {
  while (at(parent_, body) != body) {
    auto& above = parent_[static_cast<std::size_t>(body)];
    above = at(parent_, above);
    body = above;
  }
  return body;
}

bool StepGroups::join(std::int32_t a, std::int32_t b) {
  a = root_of(a);
  b = root_of(b);
  parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  return a != b;
}

void StepGroups::begin(const std::vector<TrackedContact>& contacts,
                       std::span<const BodyLink> sleeping) {
  parent_ = island_start_;
  std::fill(fraction_.begin(), fraction_.end(), 1);
  rounds_ = 0;
  const auto is_free = [&](std::int32_t body) {
    const auto b = static_cast<std::size_t>(body);
    return b < model_.body_island.size() && model_.body_island[b] >= 0;
  };
  const auto tie = [&](std::int32_t a, std::int32_t b) {
    if (is_free(a) && is_free(b)) join(a, b);
  };
  for (const TrackedContact& contact : contacts) tie(contact.key.body_a, contact.key.body_b);
  for (const auto& [a, b] : sleeping) tie(a, b);
}

void StepGroups::note_what_moves(const SurfaceMotion& motion) {
  const auto differ = [](const Point3& a, const Point3& b) { return a != b; };
  for (std::size_t b = 0; b < surfaces_.bodies.size(); ++b) {
    const CollisionBody& body = surfaces_.bodies[b];
    bool moves = false;
    for (auto v = static_cast<std::size_t>(body.first_vertex);
         v < static_cast<std::size_t>(body.vertex_end) && !moves; ++v) {
      moves = differ(motion.start.vertices[v], motion.end.vertices[v]) || motion.sagitta[v] > 0;
    }
    for (auto p = static_cast<std::size_t>(body.first_plane);
         p < static_cast<std::size_t>(body.plane_end) && !moves; ++p) {
      moves = differ(motion.start.planes[p].point, motion.end.planes[p].point) ||
              differ(motion.start.planes[p].normal, motion.end.planes[p].normal);
    }
    moves_[b] = moves;
  }
}

bool StepGroups::stop(const std::vector<TouchingPair>& hits, const SurfaceMotion& motion) {
  if (hits.empty()) return false;
  if (rounds_ == 0) note_what_moves(motion);
  const bool shortens = rounds_ < shortening_rounds;
  next_ = fraction_;
  bool has_changed = false;
  for (const TouchingPair& hit : hits) {
    const auto bodies = bodies_of(hit, surfaces_);
    double left = 1;
    std::array<bool, 2> moves{};
    for (std::size_t side = 0; side < 2; ++side) {
      moves[side] = at(moves_, bodies[side]) != 0 && at(fraction_, bodies[side]) > 0;
      if (moves[side]) left = std::min(left, at(fraction_, bodies[side]));
    }
    if (!moves[0] && !moves[1]) continue;
    has_changed = true;
    const double share = hit.time > 0 ? kept_share * std::min(hit.time, 1.0) : share_at_once;
    left *= shortens ? share : 0;
    for (std::size_t side = 0; side < 2; ++side) {
      auto& next = next_[static_cast<std::size_t>(bodies[side])];
      if (moves[side]) next = std::min(next, left);
    }
    if (moves[0] && moves[1]) join(bodies[0], bodies[1]);
  }
  // The root is the smallest of its group, so that it comes first.
  for (std::int32_t b = 0; b < static_cast<std::int32_t>(parent_.size()); ++b) {
    auto& of_root = next_[static_cast<std::size_t>(root_of(b))];
    of_root = std::min(of_root, at(next_, b));
  }
  for (std::int32_t b = 0; b < static_cast<std::int32_t>(parent_.size()); ++b) {
    fraction_[static_cast<std::size_t>(b)] = at(next_, root_of(b));
  }
  ++rounds_;
  return has_changed;
}

double StepGroups::smallest_fraction() const {
  return fraction_.empty() ? 1 : *std::min_element(fraction_.begin(), fraction_.end());
}

std::int32_t StepGroups::roots_with_unknowns(bool only_stopped) const {
  std::vector<std::int32_t> roots;
  for (std::size_t b = 0; b < model_.body_island.size(); ++b) {
    if (model_.body_island[b] < 0 || (only_stopped && fraction_[b] == 1)) continue;
    auto root = static_cast<std::int32_t>(b);
    while (at(parent_, root) != root) root = at(parent_, root);
    roots.push_back(root);
  }
  std::sort(roots.begin(), roots.end());
  return static_cast<std::int32_t>(std::unique(roots.begin(), roots.end()) - roots.begin());
}

std::int64_t StepGroups::island_count() const {
  return roots_with_unknowns(false);
}
std::int64_t StepGroups::stopped_islands() const {
  return roots_with_unknowns(true);
}

}  // namespace tetwarp

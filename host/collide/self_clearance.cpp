/// @file self_clearance.cpp
/// Compares places of vertices with those at which a clearance was measured.
#include "host/collide/self_clearance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"

namespace tetwarp {
namespace {
Point3 place(const View<const double>& places, std::int64_t vertex) {
  return {places[3 * vertex], places[3 * vertex + 1], places[3 * vertex + 2]};
}
}  // namespace

SelfClearance::SelfClearance(const CollisionSurfaces& surfaces,
                             const CollideItems& items,
                             bool is_used)
    : surfaces_(surfaces), bodies_(items.bodies) {
  for (std::size_t b = 0; b < surfaces.bodies.size() && is_used; ++b) {
    const CollisionBody& body = surfaces.bodies[b];
    if (!body.touches_itself || body.first_vertex == body.vertex_end) continue;
    entries_.emplace_back().body = static_cast<std::int32_t>(b);
  }
}

/// Counts how long the clearance has sufficed, or the updates until it is measured again.
bool SelfClearance::is_due(Entry& entry, const MotionView& motion, double distance) {
  if (is_clear(entry, motion, distance)) {
    ++entry.uses;
    return false;
  }
  if (entry.clearance > 0) {
    if (entry.uses < least_uses) {
      pause(entry);
    } else {
      entry.pause = 0;
    }
    entry.clearance = 0;
  }
  entry.uses = 0;
  if (entry.wait == 0) return true;
  --entry.wait;
  return false;
}

void SelfClearance::pause(Entry& entry) {
  entry.pause = std::min(2 * entry.pause + 1, most_pause);
  entry.wait = entry.pause;
  entry.clearance = 0;
}

void SelfClearance::set_start(Entry& entry, const MotionView& motion) const {
  const CollisionBody& body = at(surfaces_.bodies, entry.body);
  entry.start.assign(motion.start.data + 3 * std::int64_t{body.first_vertex},
                     motion.start.data + 3 * std::int64_t{body.vertex_end});
}

double SelfClearance::shortest_edge(const Entry& entry, const MotionView& motion) const {
  const CollisionBody& body = at(surfaces_.bodies, entry.body);
  double shortest = std::numeric_limits<double>::infinity();
  for (std::int32_t e = body.first_edge; e < body.edge_end; ++e) {
    const auto& [v, w] = at(surfaces_.edges, e);
    shortest = std::min(shortest, norm(minus(place(motion.start, v), place(motion.start, w))));
  }
  return shortest;
}

/// The largest displacement of a vertex since `start`, relative to that of the middle vertex, at
/// both ends of the motion: between them vertices move straight.
double SelfClearance::deformation(const Entry& entry, const MotionView& motion) const {
  const CollisionBody& body = at(surfaces_.bodies, entry.body);
  const std::int64_t first = body.first_vertex, count = body.vertex_end - first;
  const View<const double> start{entry.start.data(), std::ssize(entry.start)};
  double square = 0;
  for (const View<const double>& places : {motion.start, motion.end}) {
    const std::int64_t middle = count / 2;
    const Point3 shift = minus(place(places, first + middle), place(start, middle));
    for (std::int64_t v = 0; v < count; ++v) {
      const Point3 way = minus(minus(place(places, first + v), place(start, v)), shift);
      square = std::max(square, dot(way, way));
    }
  }
  return std::sqrt(square);
}

bool SelfClearance::is_clear(const Entry& entry, const MotionView& motion, double distance) const {
  if (!(entry.clearance > distance)) return false;
  return entry.clearance - 2 * deformation(entry, motion) > (1 + 1e-9) * distance;
}

const std::vector<CollideBody>& SelfClearance::find(const MotionView& motion, double distance) {
  for (Entry& entry : entries_) {
    entry.is_left_out = is_clear(entry, motion, distance);
    bodies_[index_of(entry.body)].touches_itself = entry.is_left_out ? 0 : 1;
  }
  return bodies_;
}

bool SelfClearance::are_clear(const MotionView& motion, double distance) const {
  return std::ranges::all_of(entries_, [&](const Entry& entry) {
    return !entry.is_left_out || is_clear(entry, motion, distance);
  });
}

}  // namespace tetwarp

/// @file contact_points.cpp
/// Places, gaps and impulses of contacts at the end of a part of a step.
#include "host/simulate/contact_step/contact_points.hpp"

#include "host/base/index_of.hpp"
#include "host/base/parallel.hpp"
#include "host/base/point3.hpp"
#include "host/simulate/contact_step/contact_impulses.hpp"
#include "host/simulate/model/rotations.hpp"

namespace tetwarp {
namespace {

/// By how much a point moves with the material of its body.
Point3 displacement_of(const Point3& start_world,
                       const MaterialPoint& point,
                       const BodyPlace& start,
                       const BodyPlace& end) {
  if (point.is_rigid()) {
    const Point3 local =
        rotate(conjugate(start.pose.rotation), minus(start_world, start.pose.position));
    const Point3 end_world = plus(end.pose.position, rotate(end.pose.rotation, local));
    return minus(end_world, start_world);
  }
  Point3 sum{0, 0, 0};
  for (std::size_t c = 0; c < 3 && point.vertex[c] >= 0; ++c) {
    const std::size_t v = index_of(point.vertex[c]);
    sum = plus(sum, times(point.weight[c], minus(end.vertices[v], start.vertices[v])));
  }
  return sum;
}

}  // namespace

ContactPlace ContactPoints::place_of(std::size_t body,
                                     std::int32_t feature,
                                     const MaterialPoint& point) const {
  ContactPlace place;
  const CollisionBody& of = surfaces_.surfaces.bodies[body];
  const std::int32_t first = of.first_vertex;
  if (point.is_rigid()) {
    const bool is_own_vertex = feature >= first && feature < of.vertex_end;
    if (is_own_vertex && at(surfaces_.surface_point, feature) >= 0) {
      place = {{at(surfaces_.surface_point, feature), -1, -1}, {1, 0, 0}};
    }
    return place;
  }
  for (std::size_t c = 0; c < 3 && point.vertex[c] >= 0; ++c) {
    place.point[c] = at(surfaces_.surface_point, first + point.vertex[c]);
    place.weight[c] = point.weight[c];
  }
  return place;
}

void ContactPoints::make(const ContactHistory& history,
                         const ContactSolution& solution,
                         const std::vector<BodyPlace>& start,
                         const std::vector<BodyPlace>& end) {
  const std::vector<TrackedContact>& contacts = *history.contacts();
  solved_.resize(contacts.size());
  if (solved_.empty()) return;
  const std::int64_t count = std::ssize(solved_);
  parallel_for(threads_for(threads_, count), count, [&](std::int64_t i) {
    const std::size_t c = index_of(i);
    const TrackedContact& contact = contacts[c];
    const std::size_t a = index_of(contact.key.body_a), b = index_of(contact.key.body_b);
    const Point3 moved_a =
        displacement_of(contact.point_a_world, contact.material_a, start[a], end[a]);
    const Point3 moved_b =
        displacement_of(contact.point_b_world, contact.material_b, start[b], end[b]);
    ContactPoint& point = solved_[c];
    point.body_a = a;
    point.body_b = b;
    point.normal = contact.axes[0];
    point.position = times(
        0.5, plus(plus(contact.point_a_world, moved_a), plus(contact.point_b_world, moved_b)));
    point.impulse = world_impulse(contact, solution.impulse.data() + 3 * c);
    point.gap = contact.gap[0] + dot(point.normal, minus(moved_a, moved_b));
    point.area = history.tracker().records()[c].area;
    point.place_a = place_of(a, contact.key.feature_a, contact.material_a);
    point.place_b = place_of(b, contact.key.feature_b, contact.material_b);
  });
}

void ContactPoints::set_intensities(const std::vector<double>& intensities) {
  for (std::size_t c = 0; c < solved_.size(); ++c) solved_[c].intensity = intensities[c];
}

void ContactPoints::finish_with(std::span<const SleepingContact> sleeping,
                                const ContactHistory& history) {
  all_.clear();
  std::size_t s = 0;
  const auto add_sleeping = [&] {
    const SleepingContact& contact = sleeping[s++];
    Point3& impulse = all_.emplace_back(contact.point).impulse;
    impulse = times(history.time_step() / contact.time_step, impulse);
  };
  for (std::size_t c = 0; c < solved_.size(); ++c) {
    const ContactKey& key = (*history.contacts())[c].key;
    while (s < sleeping.size() && sleeping[s].record.key < key) add_sleeping();
    all_.push_back(solved_[c]);
  }
  while (s < sleeping.size()) add_sleeping();
}

}  // namespace tetwarp

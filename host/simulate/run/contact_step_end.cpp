// What a step with contact leaves: impulses on bodies, contacts at its end, records, energies.
#include <algorithm>

#include "host/base/index_of.hpp"
#include "host/base/parallel.hpp"
#include "host/base/stopwatch.hpp"
#include "host/simulate/model/rotations.hpp"
#include "host/simulate/run/contact_step.hpp"
#include "host/simulate/surfaces/surface_motion.hpp"

namespace tetwarp {
namespace {

/// By how much a point moves with the material of its body.
Point3 way_of(const Point3& start_world,
              const MaterialPoint& point,
              const BodyPlace& start,
              const BodyPlace& end) {
  if (point.is_rigid()) {
    const Point3 local =
        rotate(conjugate(start.pose.rotation), minus(start_world, start.pose.position));
    const Point3 end_world = plus(end.pose.position, rotate(end.pose.rotation, local));
    return minus(end_world, start_world);
  }
  Point3 way{0, 0, 0};
  for (std::size_t c = 0; c < 3 && point.vertex[c] >= 0; ++c) {
    const auto v = static_cast<std::size_t>(point.vertex[c]);
    way = plus(way, times(point.weight[c], minus(end.vertices[v], start.vertices[v])));
  }
  return way;
}

Point3 world_impulse(const TrackedContact& contact, const double* impulse) {
  Point3 sum{0, 0, 0};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    sum = plus(sum, times(impulse[axis], contact.axes[axis]));
  }
  return sum;
}

double adhesion_energy(const ContactRecord& record,
                       const ContactMaterial& material,
                       const Point3& gap) {
  const double beta = record.intensity;
  const double normal = std::max(gap[0], 0.0);
  const double tangential = gap[1] * gap[1] + gap[2] * gap[2];
  const double stiffness = material.stiffness;
  const double elastic =
      stiffness * normal * normal + material.tangential_stiffness.value_or(stiffness) * tangential;
  return record.area * (beta * beta / 2 * elastic - material.energy * beta);
}

}  // namespace

bool ContactStep::can_touch(const CollisionSurfaces& surfaces) {
  std::vector<std::int32_t> solid;
  for (std::size_t b = 0; b < surfaces.bodies.size(); ++b) {
    const CollisionBody& body = surfaces.bodies[b];
    if (body.touches_itself && body.triangle_end > body.first_triangle) return true;
    const bool has_parts = body.vertex_end > body.first_vertex || body.plane_end > body.first_plane;
    if (has_parts) solid.push_back(static_cast<std::int32_t>(b));
  }
  const auto is_free = [&](std::int32_t b) {
    return surfaces.bodies[static_cast<std::size_t>(b)].has_unknowns;
  };
  for (std::size_t i = 0; i < solid.size(); ++i) {
    for (std::size_t j = i + 1; j < solid.size(); ++j) {
      const std::array<std::int32_t, 2> pair{solid[i], solid[j]};
      if (!is_free(pair[0]) && !is_free(pair[1])) continue;
      if (!std::binary_search(surfaces.forbidden.begin(), surfaces.forbidden.end(), pair)) {
        return true;
      }
    }
  }
  return false;
}

std::int64_t ContactStep::stalled_scripts() const {
  const auto is_driven = [&](std::int32_t block) {
    const auto i = static_cast<std::size_t>(block);
    return model_.prescribed[i] != 0 && velocity_[i] != Point3{0, 0, 0};
  };
  std::int64_t count = 0;
  for (std::size_t b = 0; b < fractions().size(); ++b) {
    if (fractions()[b] == 1) continue;
    bool is_script = false;
    if (b + 1 < model_.body_node.size()) {
      for (auto n = model_.body_node[b]; n < model_.body_node[b + 1]; ++n) {
        is_script = is_script || is_driven(n);
      }
    }
    if (const std::int32_t r = surfaces_.body_rigid[b]; r >= 0) {
      const std::int32_t block = model_.node_count + 2 * r;
      is_script = is_script || is_driven(block) || is_driven(block + 1);
    }
    count += is_script;
  }
  return count;
}

void ContactStep::sum_impulses() {
  block_impulses_ = system_.block_impulses();
  const double* impulse = system_.solution().impulse.data();
  for (const TrackedContact& contact : *contacts_) {
    const Point3 on_a = world_impulse(contact, impulse);
    auto& a = body_impulses_[static_cast<std::size_t>(contact.key.body_a)];
    auto& b = body_impulses_[static_cast<std::size_t>(contact.key.body_b)];
    a = plus(a, on_a);
    b = minus(b, on_a);
    impulse += 3;
  }
}

ContactPlace ContactStep::place_of(std::size_t body, const MaterialPoint& point) const {
  ContactPlace place;
  if (point.is_rigid()) return place;
  const std::int32_t first = surfaces_.surfaces.bodies[body].first_vertex;
  for (std::size_t c = 0; c < 3 && point.vertex[c] >= 0; ++c) {
    place.point[c] = at(surfaces_.surface_point, first + point.vertex[c]);
    place.weight[c] = point.weight[c];
  }
  return place;
}

void ContactStep::set_points() {
  own_points_.resize(contacts_->size());
  if (own_points_.empty()) return;
  const double* impulse = system_.solution().impulse.data();
  const std::int64_t count = std::ssize(own_points_);
  parallel_for(threads_for(options_.threads, count), count, [&](std::int64_t i) {
    const std::size_t c = index_of(i);
    const TrackedContact& contact = (*contacts_)[c];
    const auto a = static_cast<std::size_t>(contact.key.body_a);
    const auto b = static_cast<std::size_t>(contact.key.body_b);
    const Point3 way_a =
        way_of(contact.point_a_world, contact.material_a, start_places_[a], end_places_[a]);
    const Point3 way_b =
        way_of(contact.point_b_world, contact.material_b, start_places_[b], end_places_[b]);
    ContactPoint& point = own_points_[c];
    point.body_a = a;
    point.body_b = b;
    point.normal = contact.axes[0];
    point.position =
        times(0.5, plus(plus(contact.point_a_world, way_a), plus(contact.point_b_world, way_b)));
    point.impulse = world_impulse(contact, impulse + 3 * c);
    point.gap = contact.gap[0] + dot(point.normal, minus(way_a, way_b));
    point.area = tracker_.records()[c].area;
    point.place_a = place_of(a, contact.material_a);
    point.place_b = place_of(b, contact.material_b);
  });
}

void ContactStep::end(const ModelState& after, ContactPart& part) {
  if (contacts_ == nullptr) {
    own_points_.clear();
    if (options_.sleeps) note_rest({});
    merge_points();
    return;
  }
  const Stopwatch stopwatch;
  set_places(after, places_.of(after), end_places_);
  static const ContactSolution nothing;
  set_points();
  std::vector<double> before;
  if (options_.sleeps) {
    for (const ContactRecord& record : tracker_.records()) before.push_back(record.intensity);
  }
  const AdhesionStep adhesion =
      tracker_.end_step(contacts_->empty() ? nothing : system_.solution(), end_places_);
  for (std::size_t c = 0; c < own_points_.size(); ++c) {
    own_points_[c].intensity = adhesion.intensity[c];
  }
  merge_points();
  if (options_.sleeps) note_rest(before);
  part.contact_seconds += stopwatch.seconds();
}

/// Impulses of another step are a guess for those of this one, in proportion to its time.
void ContactStep::set_time_step(double time_step) {
  if (time_step_ > 0 && time_step_ != time_step) {
    const double ratio = time_step / time_step_;
    for (Point3& change : change_) change = times(ratio, change);
    std::vector<ContactRecord> records = tracker_.records();
    for (ContactRecord& record : records) {
      record.impulse_world = times(ratio, record.impulse_world);
    }
    tracker_ = ContactTracker(tracker_options_, std::move(records));
  }
  time_step_ = time_step;
}

void ContactStep::restore(const ContactMemory& memory) {
  tracker_ = ContactTracker(tracker_options_, memory.records);
  time_step_ = memory.time_step;
  change_ = memory.change;
  set_sleeping(memory.sleeping);
}

void ContactStep::record(const ModelState& state, StepRecord& record) {
  const SurfacePlaces& places = places_.of(state);
  const double cap = 100 * surfaces_.surfaces.thickness;
  MotionView on_device;
  if (resident_ != nullptr) {
    resident_->begin(binding_of(surfaces_));
    on_device = view_of(resident_->move({}, 0, {}));
  }
  record.smallest_distance = detector_->closest(places, cap, on_device).distance;
  ContactTracker now(tracker_options_, bonds());
  set_places(state, places, end_places_);
  // Without reports the contacts are those that adhere, between their anchors.
  const std::vector<TrackedContact>& bonds = now.begin_step({}, end_places_, scene_.time_step);
  for (std::size_t c = 0; c < bonds.size(); ++c) {
    const ContactRecord& bond = now.records()[c];
    const auto material = static_cast<std::size_t>(bond.material);
    record.energy.adhesion +=
        adhesion_energy(bond, tracker_options_.materials[material], bonds[c].gap);
    record.adhered_area += bond.intensity * bond.area;
  }
}

}  // namespace tetwarp

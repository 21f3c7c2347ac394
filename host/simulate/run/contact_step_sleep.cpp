// Contacts between bodies that stand still: kept as they are while their bodies sleep.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "host/base/point3.hpp"
#include "host/simulate/run/contact_step.hpp"
#include "host/simulate/solve/problem/step_rows.hpp"

namespace tetwarp {
namespace {

constexpr double calm_bond_rate = 1e-6;  // of the intensity [1/s]
constexpr double calm_slip = 0.1;        // of the speed at which a body counts as at rest

bool key_is_less(const ContactRecord& a, const ContactRecord& b) {
  return a.key < b.key;
}

BodyLink bodies_of(const ContactKey& key) {
  return {key.body_a, key.body_b};
}

}  // namespace

void ContactStep::set_still(std::span<const std::uint8_t> is_still) {
  if (is_still.empty() && still_.empty()) return;
  still_.assign(is_still.begin(), is_still.end());
  detector_->set_still(still_);
}

bool ContactStep::both_still(const BodyLink& bodies) const {
  return still_[static_cast<std::size_t>(bodies[0])] != 0 &&
         still_[static_cast<std::size_t>(bodies[1])] != 0;
}

/// The records of contacts that adhere.
std::vector<ContactRecord> ContactStep::bonds() const {
  std::vector<ContactRecord> all;
  const auto add = [&](const ContactRecord& record) {
    if (record.intensity > 0) all.push_back(record);
  };
  std::ranges::for_each(tracker_.start_records(), add);
  const auto awake = std::ssize(all);
  std::ranges::for_each(sleeping_, add, &SleepingContact::record);
  std::inplace_merge(all.begin(), all.begin() + awake, all.end(), key_is_less);
  return all;
}

void ContactStep::thaw(std::span<const std::uint8_t> is_still) {
  set_still(is_still);
  if (sleeping_.empty()) return;
  std::vector<SleepingContact> still;
  std::vector<ContactRecord> woken, all;
  for (const SleepingContact& contact : sleeping_) {
    if (!still_.empty() && both_still(bodies_of(contact.record.key))) {
      still.push_back(contact);
    } else {
      woken.push_back(contact.record);
      Point3& impulse = woken.back().impulse_world;
      impulse = times(time_step_ / contact.time_step, impulse);
    }
  }
  const std::vector<ContactRecord>& awake = tracker_.start_records();
  std::merge(awake.begin(), awake.end(), woken.begin(), woken.end(), std::back_inserter(all),
             key_is_less);
  tracker_ = ContactTracker(tracker_options_, std::move(all));
  set_sleeping(std::move(still));
}

void ContactStep::freeze(std::span<const std::uint8_t> is_still) {
  set_still(is_still);
  if (still_.empty() || contacts_ == nullptr) return;
  const std::vector<ContactRecord>& records = tracker_.records();
  std::vector<ContactRecord> awake;
  std::vector<SleepingContact> asleep;
  std::size_t c = 0;
  for (const ContactRecord& record : records) {
    while (c < contacts_->size() && (*contacts_)[c].key < record.key) ++c;
    const bool has_contact = c < contacts_->size() && (*contacts_)[c].key == record.key;
    if (has_contact && both_still(bodies_of(record.key))) {
      asleep.push_back({record, (*contacts_)[c], own_points_[c], time_step_});
    } else {
      awake.push_back(record);
    }
  }
  std::vector<SleepingContact> all;
  std::merge(sleeping_.begin(), sleeping_.end(), asleep.begin(), asleep.end(),
             std::back_inserter(all), [](const SleepingContact& a, const SleepingContact& b) {
               return a.record.key < b.record.key;
             });
  set_sleeping(std::move(all));
  tracker_ = ContactTracker(tracker_options_, std::move(awake));
  contacts_ = nullptr;
}

void ContactStep::set_sleeping(std::vector<SleepingContact> contacts) {
  sleeping_ = std::move(contacts);
  sleeping_links_.clear();
  for (const SleepingContact& contact : sleeping_) {
    sleeping_links_.push_back(bodies_of(contact.record.key));
  }
  has_sleeping_forces_ = false;
}

/// Adds what contacts between bodies that stand still do in a part of a step.
void ContactStep::add_sleeping(const ModelState& state, double time_step, ContactPart& part) {
  if (sleeping_.empty()) return;
  if (!has_sleeping_forces_) set_sleeping_forces(state);
  part.contacts += static_cast<std::int64_t>(sleeping_.size());
  for (const SleepingContact& contact : sleeping_) {
    const Point3 on_a = times(time_step / contact.time_step, contact.point.impulse);
    Point3& a = body_impulses_[contact.point.body_a];
    Point3& b = body_impulses_[contact.point.body_b];
    a = plus(a, on_a);
    b = minus(b, on_a);
  }
  for (const auto& [block, force] : sleeping_forces_) {
    Point3& of_block = block_impulses_[static_cast<std::size_t>(block)];
    of_block = plus(of_block, times(time_step, force));
  }
}

void ContactStep::set_sleeping_forces(const ModelState& state) {
  std::vector<TrackedContact> contacts;
  std::vector<double> forces;  // along the axes of each contact
  for (const SleepingContact& of : sleeping_) {
    contacts.push_back(of.contact);
    for (const Point3& axis : of.contact.axes) {
      forces.push_back(dot(of.point.impulse, axis) / of.time_step);
    }
  }
  StepRows rows(surfaces_, model_, options_.threads);
  rows.begin(state, contacts);
  rows.set_all();
  std::vector<Point3> sums;
  rows.prescribed_impulses(forces, sums);
  sleeping_forces_.clear();
  for (std::size_t block = 0; block < sums.size(); ++block) {
    if (sums[block] == Point3{0, 0, 0}) continue;
    sleeping_forces_.emplace_back(static_cast<std::int32_t>(block), sums[block]);
  }
  has_sleeping_forces_ = true;
}

/// Points of all contacts, those between bodies that stand still included, in the order of keys.
void ContactStep::merge_points() {
  if (!options_.sleeps) return points_.swap(own_points_);
  points_.clear();
  std::size_t s = 0;
  const auto add_sleeping = [&] {
    const SleepingContact& contact = sleeping_[s++];
    Point3& impulse = points_.emplace_back(contact.point).impulse;
    impulse = times(time_step_ / contact.time_step, impulse);
  };
  for (std::size_t c = 0; c < own_points_.size(); ++c) {
    const ContactKey& key = (*contacts_)[c].key;
    while (s < sleeping_.size() && sleeping_[s].record.key < key) add_sleeping();
    points_.push_back(own_points_[c]);
  }
  while (s < sleeping_.size()) add_sleeping();
}

/// @param before  intensities of the contacts at the start of the part
void ContactStep::note_rest(const std::vector<double>& before) {
  rest_.links.clear();
  rest_.is_restless.assign(surfaces_.surfaces.bodies.size(), 0);
  for (std::size_t b = 0; b < fractions().size(); ++b) rest_.is_restless[b] = fractions()[b] < 1;
  for (std::size_t c = 0; c < own_points_.size(); ++c) {
    const TrackedContact& contact = (*contacts_)[c];
    const BodyLink bodies = bodies_of(contact.key);
    rest_.links.push_back(bodies);
    const double* const impulse = system_.solution().impulse.data() + 3 * c;
    const double* const velocity = system_.solution().velocity.data() + 3 * c;
    const auto a = static_cast<std::size_t>(bodies[0]), b = static_cast<std::size_t>(bodies[1]);
    const auto material = static_cast<std::size_t>(surfaces_.material_of(bodies[0], bodies[1]));
    const double friction = surfaces_.materials[material].friction;
    const bool is_at_limit =
        std::hypot(impulse[1], impulse[2]) >= (1 - 1e-6) * friction * impulse[0];
    const double size = std::min(surfaces_.body_size[a], surfaces_.body_size[b]);
    const double slip = calm_slip * IslandSleep::rest_speed * size;
    const bool slides = is_at_limit && std::hypot(velocity[1], velocity[2]) > slip;
    const double bonding = std::abs(own_points_[c].intensity - before[c]);
    if (slides || bonding > calm_bond_rate * time_step_) {
      rest_.is_restless[a] = rest_.is_restless[b] = 1;
    }
  }
}

}  // namespace tetwarp

/// @file sleeping_contacts.cpp
/// Keeps, wakes and records contacts between bodies that stand still.
#include "host/simulate/contact_step/sleeping_contacts.hpp"

#include <algorithm>
#include <iterator>

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"
#include "host/simulate/solve/problem/step_rows.hpp"

namespace tetwarp {

void SleepingContacts::set(std::vector<SleepingContact> contacts) {
  contacts_ = std::move(contacts);
  links_.clear();
  for (const SleepingContact& contact : contacts_) links_.push_back(link_of(contact.record.key));
  has_forces_ = false;
}

void SleepingContacts::set_still(std::span<const std::uint8_t> is_still) {
  still_.assign(is_still.begin(), is_still.end());
}

bool SleepingContacts::both_still(const ContactKey& key) const {
  return still_[index_of(key.body_a)] != 0 && still_[index_of(key.body_b)] != 0;
}

std::vector<ContactRecord> SleepingContacts::thaw(double time_step) {
  std::vector<SleepingContact> kept;
  std::vector<ContactRecord> woken;
  for (const SleepingContact& contact : contacts_) {
    if (!still_.empty() && both_still(contact.record.key)) {
      kept.push_back(contact);
    } else {
      woken.push_back(contact.record);
      Point3& impulse = woken.back().impulse_world;
      impulse = times(time_step / contact.time_step, impulse);
    }
  }
  set(std::move(kept));
  return woken;
}

std::vector<ContactRecord> SleepingContacts::freeze(const ContactHistory& history,
                                                    const std::vector<ContactPoint>& points) {
  const std::vector<TrackedContact>& contacts = *history.contacts();
  std::vector<ContactRecord> awake;
  std::vector<SleepingContact> asleep;
  std::size_t c = 0;
  for (const ContactRecord& record : history.tracker().records()) {
    while (c < contacts.size() && contacts[c].key < record.key) ++c;
    const bool has_contact = c < contacts.size() && contacts[c].key == record.key;
    if (has_contact && both_still(record.key)) {
      asleep.push_back({record, contacts[c], points[c], history.time_step()});
    } else {
      awake.push_back(record);
    }
  }
  std::vector<SleepingContact> all;
  std::merge(contacts_.begin(), contacts_.end(), asleep.begin(), asleep.end(),
             std::back_inserter(all), [](const SleepingContact& a, const SleepingContact& b) {
               return a.record.key < b.record.key;
             });
  set(std::move(all));
  return awake;
}

void SleepingContacts::add_impulses(const ModelState& state,
                                    double time_step,
                                    ContactImpulses& impulses) {
  if (contacts_.empty()) return;
  if (!has_forces_) set_forces(state);
  for (const SleepingContact& contact : contacts_) {
    impulses.add_pair(contact.point.body_a, contact.point.body_b,
                      times(time_step / contact.time_step, contact.point.impulse));
  }
  for (const auto& [block, force] : forces_) impulses.add_on_block(block, times(time_step, force));
}

void SleepingContacts::set_forces(const ModelState& state) {
  std::vector<TrackedContact> contacts;
  std::vector<double> forces;  // along the axes of each contact
  for (const SleepingContact& of : contacts_) {
    contacts.push_back(of.contact);
    for (const Point3& axis : of.contact.axes) {
      forces.push_back(dot(of.point.impulse, axis) / of.time_step);
    }
  }
  StepRows rows(surfaces_, model_, threads_);
  rows.begin(state, contacts);
  rows.set_all();
  std::vector<Point3> sums;
  rows.prescribed_impulses(forces, sums);
  forces_.clear();
  for (std::size_t block = 0; block < sums.size(); ++block) {
    if (sums[block] == Point3{0, 0, 0}) continue;
    forces_.emplace_back(static_cast<std::int32_t>(block), sums[block]);
  }
  has_forces_ = true;
}

}  // namespace tetwarp

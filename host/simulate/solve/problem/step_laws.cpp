/// @file step_laws.cpp
/// Sets restitution, recovery and bonds of contacts.
#include "host/simulate/solve/problem/step_laws.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"

namespace tetwarp {

double StepLaws::recovery_speed(const ContactKey& key) const {
  return recovery_fraction_ *
         std::min(scene_.body_size[index_of(key.body_a)], scene_.body_size[index_of(key.body_b)]);
}

/// A contact that is not reported is a bond of surfaces that no longer touch. The sideways distance
/// of its ends is added to its gap, so that the ends can pass each other without pushing. If its
/// normal has turned away so far that its ends seem to overlap, its normal spring is off, because
/// it would push against the contacts at that place.
void StepLaws::set_bond(const TrackedContact& contact, std::size_t c) {
  double way = std::hypot(contact.gap[1], contact.gap[2]);
  if (contact.gap[0] < 0) way += scene_.surfaces.thickness - 2 * contact.gap[0];
  if (contact.gap[0] <= 0) laws_.adhesion.stiffness[c] = 0;
  recovered_[c] = std::max(recovered_[c], way / laws_.adhesion.time_step);
}

void StepLaws::keep_impulses(const std::vector<TrackedContact>& contacts,
                             const std::vector<double>& impulse) {
  kept_.clear();
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const auto& axes = contacts[c].axes;
    Point3 sum = times(impulse[3 * c], axes[0]);
    for (std::size_t k = 1; k < 3; ++k) sum = plus(sum, times(impulse[3 * c + k], axes[k]));
    kept_.push_back({contacts[c].key, sum});
  }
}

/// Both lists are sorted by key.
void StepLaws::set_guess(const std::vector<TrackedContact>& contacts) {
  auto kept = kept_.begin();
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    while (kept != kept_.end() && kept->key < contacts[c].key) ++kept;
    if (kept == kept_.end()) return;
    if (contacts[c].key < kept->key) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      laws_.impulse_guess[3 * c + k] = dot(contacts[c].axes[k], kept->impulse);
    }
  }
}

void StepLaws::set(const ContactTracker& tracker,
                   const std::vector<TrackedContact>& contacts,
                   const StepRows& rows,
                   const std::vector<Point3>& velocity) {
  tracker.fill(laws_);
  set_guess(contacts);
  const double time_step = laws_.adhesion.time_step;
  recovered_.assign(contacts.size(), 0);
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const TrackedContact& contact = contacts[c];
    const double closing = contact.gap[0] / time_step, limit = -recovery_speed(contact.key);
    const bool rebounds = contact.rebound_speed > 0 && -contact.rebound_speed <= closing;
    if (closing < limit && !rebounds) {
      const double slowest =
          contact.rebound_speed > 0 ? std::min(limit, -contact.rebound_speed) : limit;
      recovered_[c] = std::max(slowest - closing, 0.0);
    }
    if (!contact.is_reported) set_bond(contact, c);
    laws_.velocity_offset[3 * c] += recovered_[c];
    const Point3 prescribed = rows.prescribed_velocity(c, velocity);
    for (std::size_t k = 0; k < 3; ++k) laws_.velocity_offset[3 * c + k] += prescribed[k];
    laws_.adhesion.gap[3 * c] += time_step * prescribed[0];
  }
}

}  // namespace tetwarp

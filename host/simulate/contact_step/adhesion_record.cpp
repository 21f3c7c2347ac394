/// @file adhesion_record.cpp
/// Sums energies and areas of bonds over the records of contacts.
#include "host/simulate/contact_step/adhesion_record.hpp"

#include <algorithm>

#include "host/base/point3.hpp"

namespace tetwarp {
namespace {

/// The records of contacts that adhere, sorted by key.
std::vector<ContactRecord> bonds_of(const ContactHistory& history,
                                    const SleepingContacts& sleeping) {
  std::vector<ContactRecord> all;
  const auto add = [&](const ContactRecord& record) {
    if (record.intensity > 0) all.push_back(record);
  };
  std::ranges::for_each(history.tracker().start_records(), add);
  const auto awake = std::ssize(all);
  std::ranges::for_each(sleeping.list(), add, &SleepingContact::record);
  std::inplace_merge(all.begin(), all.begin() + awake, all.end(),
                     [](const ContactRecord& a, const ContactRecord& b) { return a.key < b.key; });
  return all;
}

/// A (beta^2 / 2 (C_n max(gap_n, 0)^2 + C_t |gap_t|^2) - W beta)
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

void add_bonds(const ContactHistory& history,
               const SleepingContacts& sleeping,
               const std::vector<BodyPlace>& bodies,
               double time_step,
               StepRecord& record) {
  ContactTracker tracker(history.options(), bonds_of(history, sleeping));
  // Without reports the contacts are those that adhere, between their anchors.
  const std::vector<TrackedContact>& contacts =
      tracker.begin_step(std::span<const ReportedContact>{}, bodies, time_step);
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const ContactRecord& bond = tracker.records()[c];
    record.energy.adhesion +=
        adhesion_energy(bond, at(history.options().materials, bond.material), contacts[c].gap);
    record.adhered_area += bond.intensity * bond.area;
  }
}

}  // namespace tetwarp

/// @file sleeping_contacts.hpp
/// SleepingContacts: contacts between bodies that stand still.
#pragma once
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "host/simulate/contact_step/body_link.hpp"
#include "host/simulate/contact_step/contact_history.hpp"
#include "host/simulate/contact_step/contact_impulses.hpp"
#include "host/simulate/contact_step/contact_memory.hpp"
#include "host/simulate/surfaces/scene_surfaces.hpp"

namespace tetwarp {

/// They are not solved: impulses stay those of the last step that solved them, in proportion to the
/// time step.
class SleepingContacts {
 public:
  /// @param surfaces, model  kept by the caller
  SleepingContacts(const SceneSurfaces& surfaces, const Model& model, int threads)
      : surfaces_(surfaces), model_(model), threads_(threads) {}

  /// Sorted by key.
  const std::vector<SleepingContact>& list() const { return contacts_; }
  void set(std::vector<SleepingContact> contacts);
  /// The bodies of each contact.
  const std::vector<BodyLink>& links() const { return links_; }

  /// Whether bodies and obstacles stand still, [bodies, then obstacles] or empty: none does.
  const std::vector<std::uint8_t>& still() const { return still_; }
  void set_still(std::span<const std::uint8_t> is_still);
  /// Removes the contacts of bodies of which one no longer stands still.
  /// @param time_step  for their impulses [s]
  /// @returns their records, sorted by key
  std::vector<ContactRecord> thaw(double time_step);
  /// Adds the contacts of a part between bodies that stand still.
  /// @param history  of a part that has ended with contacts
  /// @param points   [contacts] at its end
  /// @returns records of the other contacts, sorted by key
  std::vector<ContactRecord> freeze(const ContactHistory& history,
                                    const std::vector<ContactPoint>& points);

  /// Adds the impulses in a part of `time_step` seconds that starts in `state`.
  void add_impulses(const ModelState& state, double time_step, ContactImpulses& impulses);

 private:
  bool both_still(const ContactKey& key) const;
  void set_forces(const ModelState& state);

  const SceneSurfaces& surfaces_;
  const Model& model_;
  int threads_;
  std::vector<SleepingContact> contacts_;
  std::vector<BodyLink> links_;
  std::vector<std::pair<std::int32_t, Point3>> forces_;  ///< on prescribed blocks [N, N m]
  bool has_forces_ = false;                              ///< forces_ is that of contacts_
  std::vector<std::uint8_t> still_;
};

}  // namespace tetwarp

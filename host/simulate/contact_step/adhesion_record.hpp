/// @file adhesion_record.hpp
/// The adhesion's energy and area in a state.
#pragma once
#include <span>
#include <vector>

#include <tetwarp/contact_tracker.hpp>
#include <tetwarp/simulate.hpp>

#include "host/simulate/contact_step/contact_history.hpp"
#include "host/simulate/contact_step/sleeping_contacts.hpp"

namespace tetwarp {

/// Adds the energy and the area of all bonds to a record.
/// @param bodies     in the state
/// @param time_step  [s] > 0
void add_bonds(const ContactHistory& history,
               const SleepingContacts& sleeping,
               const std::vector<BodyPlace>& bodies,
               double time_step,
               StepRecord& record);

}  // namespace tetwarp

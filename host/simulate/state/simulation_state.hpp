/// @file simulation_state.hpp
/// SimulationState: what a simulation goes on from, as a value.
#pragma once
#include <cstdint>
#include <vector>

#include "host/simulate/contact_step/contact_memory.hpp"
#include "host/simulate/model/model.hpp"
#include "host/simulate/state/added_handles.hpp"
#include "host/simulate/state/checkpoint_bytes.hpp"
#include "host/simulate/state/island_sleep.hpp"
#include "host/simulate/state/last_step.hpp"
#include "host/simulate/state/step_division.hpp"
#include "host/simulate/step/scene_drive.hpp"

namespace tetwarp {

/// What the bodies take from one part of a step to the next, besides their ModelState. A step that
/// fails goes back to a copy of it.
struct BodyMemory {
  DriveState drive;
  ContactMemory contacts;
  SleepState sleep;
};

/// All that the steps to come and the records of the last one depend on, in an equal scene with the
/// same options.
struct SimulationState {
  std::int64_t steps = 0;  ///< done
  DivisionState division;
  LastStep last;
  ModelState bodies;
  BodyMemory memory;
  DriveOverrides overrides;
  std::vector<AddedHandle> added = {};  ///< as SimulatedScene::added
};

/// Writes all but the added handles.
void write_state(const SimulationState& state, CheckpointWriter& writer);
/// @param state  in: of the same scene and handles, for the lengths of lists; members that a
/// checkpoint does
///               not hold stay; out: as written
/// @throws std::invalid_argument  the bytes are damaged
void read_state(CheckpointReader& reader, SimulationState& state);

}  // namespace tetwarp

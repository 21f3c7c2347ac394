/// @file saved_state.hpp
/// SavedState: what a checkpoint holds of a simulation.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "host/simulate/contact_step/contact_memory.hpp"
#include "host/simulate/model/model.hpp"
#include "host/simulate/run/checkpoint_bytes.hpp"
#include "host/simulate/run/island_sleep.hpp"
#include "host/simulate/run/last_step.hpp"
#include "host/simulate/step/scene_drive.hpp"

namespace tetwarp {

struct SavedState {
  std::int64_t steps = 0;  ///< done
  std::int64_t held_steps = 0, undivided_steps = 0;
  LastStep last;  ///< what StepRecords read
  ModelState state;
  std::vector<std::optional<Point3>> handles;
  DriveOverrides overrides;
  std::vector<double> delays;
  ContactMemory memory;
  SleepState sleep;
};

void write_state(const SavedState& saved, CheckpointWriter& writer);
/// @param saved  in: of the same scene, for the lengths of lists; members that a checkpoint does
///               not hold stay; out: as written
/// @throws std::invalid_argument  the bytes are damaged
void read_state(CheckpointReader& reader, SavedState& saved);

}  // namespace tetwarp

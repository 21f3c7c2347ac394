/// @file contact_memory.hpp
/// What contacts keep from step to step.
#pragma once
#include <vector>

#include <tetwarp/contact_tracker.hpp>
#include <tetwarp/simulate.hpp>

namespace tetwarp {

/// A contact between two bodies that stand still, as it was in the last step that solved it.
struct SleepingContact {
  ContactRecord record;
  TrackedContact contact;
  ContactPoint point;
  double time_step = 0;  ///< over which the impulse acted [s]
};

struct ContactMemory {
  double time_step = 0;  ///< over which impulses and changes of velocities acted [s]
  std::vector<ContactRecord> records;
  std::vector<Point3> change;             ///< of velocities by contacts in the last step, or empty
  std::vector<SleepingContact> sleeping;  ///< sorted by key
};

}  // namespace tetwarp

/// @file contact_io.hpp
/// Checkpoints of simulations with tracked contacts, in HDF5.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/contact_tracker.hpp>
#include <tetwarp/error.hpp>
#include <tetwarp/io_export.hpp>

namespace tetwarp {

/// The state of a simulation with tracked contacts: restored from it, further steps have the same
/// bits as without a stop.
struct ContactCheckpoint {
  std::int64_t step = 0;               ///< steps done
  double time = 0;                     ///< [s]
  std::vector<BodyPose> poses;         ///< of all bodies, world
  std::vector<double> body_velocity;   ///< [dofs], as in ContactSolution [m/s, rad/s]
  std::vector<ContactRecord> records;  ///< ContactTracker::records()
};

/// Writes a checkpoint, under a temporary name until it is complete.
/// @throws IoError when the file cannot be written
/// @returns bytes of the file
TETWARP_IO_EXPORT std::int64_t write_contact_checkpoint(const std::string& path,
                                                        const ContactCheckpoint& checkpoint);

/// Reads a checkpoint.
/// @throws IoError when the file is not a checkpoint, is of a later version, or its arrays have
///                 sizes that contradict each other
TETWARP_IO_EXPORT ContactCheckpoint read_contact_checkpoint(const std::string& path);

}  // namespace tetwarp

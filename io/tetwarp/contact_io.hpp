/// @file contact_io.hpp
/// Simulations of contact that stop and go on: checkpoints in HDF5.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/contact_tracker.hpp>
#include <tetwarp/error.hpp>
#include <tetwarp/io_export.hpp>

namespace tetwarp {

/// Everything that a simulation with tracked contacts needs to go on bit for bit.
struct ContactCheckpoint {
  std::int64_t step = 0;
  double time = 0;                     ///< [s]
  std::vector<BodyPose> poses;         ///< of all bodies
  std::vector<double> body_velocity;   ///< v, [dofs], as in ContactSolution
  std::vector<ContactRecord> records;  ///< ContactTracker::records()
};

/// Writes a checkpoint, under a temporary name until it is complete. Throws IoError.
/// @returns bytes of the file
TETWARP_IO_EXPORT std::int64_t write_contact_checkpoint(const std::string& path,
                                                        const ContactCheckpoint& checkpoint);

/// Reads a checkpoint. Throws IoError when the file is no checkpoint, of a later version, or its
/// arrays do not fit each other.
TETWARP_IO_EXPORT ContactCheckpoint read_contact_checkpoint(const std::string& path);

}  // namespace tetwarp

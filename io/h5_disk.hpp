/// @file h5_disk.hpp
/// HDF5's way to the disk: a file driver that survives full disks and damaged files.
///
/// HDF5 cannot close a file that it failed to write: the identifier stays, and the library's own
/// clean-up at exit runs into it and crashes. So writes never fail for HDF5: the driver keeps the
/// first refusal of the disk and swallows what comes after. Reading, it keeps HDF5's metadata
/// accumulator out, which copies to null in damaged files (seen in 1.10.8).
#pragma once
#include "io/h5.hpp"

namespace tetwarp::h5 {

/// What the disk said.
struct Disk {
  int error = 0;  ///< error number of the first write it refused, 0: none

  /// Throws IoError about `object` when a write was refused.
  void check(const Object& object) const;
};

/// Properties for H5Fopen (no `disk`) and H5Fcreate (refused writes are kept in `disk`, which must
/// live longer than the file).
Handle disk_access(Disk* disk);

/// Creates a file as `temporary`; messages call it `path`. Check `disk` now and then, and after the
/// file is closed.
Object create_file(const std::string& path, const std::string& temporary, Disk& disk);

}  // namespace tetwarp::h5

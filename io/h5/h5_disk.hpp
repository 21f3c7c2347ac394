/// @file h5_disk.hpp
/// A file driver for HDF5 that works around its crashes on full disks and damaged files.
///
/// HDF5 cannot close a file after a failed write: the identifier stays open, and the library's
/// clean-up at exit crashes on it. So the driver reports every write as successful, stores the
/// first error and writes nothing after it. For reading it turns off the metadata accumulator,
/// which writes to a null pointer in damaged files (HDF5 1.10.8).
#pragma once
#include "io/h5/h5.hpp"

namespace tetwarp::h5 {

/// State of a file that is written.
struct Disk {
  int error = 0;  ///< errno of the first write that failed, 0: none

  /// Throws IoError about `object` when a write has failed.
  void check(const Object& object) const;
};

/// Properties for H5Fopen (null) and H5Fcreate (`disk` receives the first failed write; it must
/// outlive the file).
Handle disk_access(Disk* disk);

/// Creates a file as `temporary`; messages name it `path`. Call Disk::check() after large writes
/// and after the file is closed.
Object create_file(const std::string& path, const std::string& temporary, Disk& disk);

}  // namespace tetwarp::h5

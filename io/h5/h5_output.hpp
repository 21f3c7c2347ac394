/// @file h5_output.hpp
/// HDF5 files that get their name when they are complete, new ones and changed copies.
#pragma once
#include <cstdint>
#include <string>

#include "io/files/finished_file.hpp"
#include "io/h5/h5.hpp"
#include "io/h5/h5_disk.hpp"

namespace tetwarp::h5 {

/// A file that is being written; removed unless finish() is called.
class OutputFile {
 public:
  explicit OutputFile(const std::string& path);

  /// Begins with a copy of the file `original`, byte by byte: H5Ocopy would also read parts that
  /// are not needed and crash where they are damaged.
  OutputFile(const std::string& path, const std::string& original);

  const Object& file() const { return file_; }

  /// Removes what is called so, if there is such a thing.
  void remove(const std::string& name);

  /// Closes, flushes and renames. Everything else that is open in the file must be closed before.
  /// @returns bytes of the file
  std::int64_t finish();

 private:
  FinishedFile finished_;
  Disk disk_;
  Object file_;
};

}  // namespace tetwarp::h5

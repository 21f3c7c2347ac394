/// @file vtkhdf_output.hpp
/// Shared by writers of VTKHDF files: temporary file, root group, attributes, closing.
#pragma once
#include <cstdint>
#include <string>

#include "io/files/finished_file.hpp"
#include "io/h5/h5_disk.hpp"

namespace tetwarp {

/// A VTKHDF file that is being written; removed unless finish() is called.
class VtkhdfOutput {
 public:
  /// Creates /VTKHDF with Version ([2,0] when temporal, else [1,0]) and Type. Throws IoError.
  VtkhdfOutput(const std::string& path, const std::string& type, bool is_temporal);

  const h5::Object& root() const { return root_; }

  /// Throws IoError about `object` when a write has failed.
  void check_disk(const h5::Object& object) const { disk_.check(object); }

  /// Closes, flushes and renames. Everything else that is open in the file must be closed before.
  /// @returns bytes of the file
  std::int64_t finish();

 private:
  FinishedFile finished_;
  h5::Disk disk_;
  h5::Object file_;
  h5::Object root_;
};

}  // namespace tetwarp

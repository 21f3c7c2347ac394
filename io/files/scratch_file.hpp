/// @file scratch_file.hpp
/// A file without a name: the system removes it when the process ends, however it ends.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>

namespace tetwarp {

/// Bytes on a disk without a name in a folder.
class ScratchFile {
 public:
  /// @param beside  the file stands in for this one, in whose folder it takes its space and which
  ///                messages name
  /// @throws IoError when the folder cannot be written to
  explicit ScratchFile(const std::string& beside);
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  ~ScratchFile();

  int descriptor() const { return descriptor_; }
  /// Other processes of the user can open the file by this path until the destructor has run.
  std::string path() const;

 private:
  int descriptor_ = -1;
};

/// Reads or writes all of `bytes` at an offset of an open file. @returns false on an error or when
/// the file ends before; errno is 0 then
bool read_at(int descriptor, void* out, std::size_t bytes, std::int64_t offset);
bool write_at(int descriptor, const void* in, std::size_t bytes, std::int64_t offset);

}  // namespace tetwarp

/// @file finished_file.hpp
/// Files that stand under their name only when they are complete.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace tetwarp {

/// A file in the making: a temporary name in the folder of `path`, moved to `path` by finish().
///
/// The temporary name is `.<pid>.<count>.tmp.<name>`, so that the extension stays; it is created
/// empty and exclusively, so that a folder nobody may write to is found out before any work.
class FinishedFile {
 public:
  /// Throws IoError when the folder cannot be written to or `path` is there and not a plain file.
  explicit FinishedFile(const std::string& path);
  FinishedFile(const FinishedFile&) = delete;
  FinishedFile& operator=(const FinishedFile&) = delete;
  ~FinishedFile();  ///< without finish(): removes the temporary

  /// The name as the caller gave it, for messages.
  const std::string& path() const { return path_; }

  /// The name to write to meanwhile.
  const std::string& temporary() const { return temporary_; }

  /// Flushes the closed temporary to the disk and renames it. Throws IoError.
  /// @returns bytes of the file
  std::int64_t finish();

 private:
  std::string path_;
  std::string temporary_;
  int slot_ = -1;  // in the list of remove_unfinished_files(); -1: not listed
};

/// Writes `content` as the file `path`. Throws IoError.
/// @returns bytes of the file
std::int64_t write_finished_file(const std::string& path, std::string_view content);

/// Removes the temporaries of all files in the making of this process, for exits that unwind no
/// stack. Async-signal-safe. The first 64 files at a time with names under 4096 bytes are known.
void remove_unfinished_files() noexcept;

}  // namespace tetwarp

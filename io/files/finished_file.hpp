/// @file finished_file.hpp
/// Files that have a temporary name until they are complete.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <tetwarp/io_export.hpp>

namespace tetwarp {

/// A file that is being written under a temporary name in the folder of `path`; finish() renames
/// it.
///
/// A symbolic link stays: the file that it leads to is written. The temporary name is
/// `.<pid>-<place>.<count>.tmp.<name>`, which keeps the extension; <place> stands for the machine
/// and its numbering of processes. The constructor creates it empty, so that a folder without write
/// permission is found before any work. Before the first file in a folder it removes the temporary
/// files there of processes of this machine that no longer exist.
class FinishedFile {
 public:
  /// Makes the folder if it is missing. Throws IoError when it cannot be written to or `path`
  /// exists and is not a plain file.
  explicit FinishedFile(const std::string& path);
  FinishedFile(const FinishedFile&) = delete;
  FinishedFile& operator=(const FinishedFile&) = delete;
  ~FinishedFile();  ///< without finish(): removes the temporary, and folders that it has made

  /// The name as the caller gave it, for messages.
  const std::string& path() const { return path_; }

  /// The temporary name, to write to.
  const std::string& temporary() const { return temporary_; }

  /// Flushes the temporary file, which must be closed, to the disk and renames it. Throws IoError.
  /// @returns bytes of the file
  std::int64_t finish();

 private:
  std::string path_;
  std::string final_;  // the file that path_ leads to
  std::string temporary_;
  std::vector<std::string> made_folders_;  // the outermost first
  int slot_ = -1;  // in the list of remove_unfinished_files(); -1: not listed
};

/// The file that a path leads to through symbolic links, also when it does not exist yet.
TETWARP_IO_EXPORT std::string link_target(const std::string& path);

/// Writes `content` as the file `path`. Throws IoError.
/// @returns bytes of the file
TETWARP_IO_EXPORT std::int64_t write_finished_file(const std::string& path,
                                                   std::string_view content);

/// Removes the temporary files of this process, for exits that run no destructors.
/// Async-signal-safe. Limited to 64 files at a time, with names below 4096 bytes.
TETWARP_IO_EXPORT void remove_unfinished_files() noexcept;

}  // namespace tetwarp

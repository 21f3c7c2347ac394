/// @file finished_file.cpp
/// Renames a file when it is complete, and removes it otherwise.
#include "io/files/finished_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <tetwarp/error.hpp>

#include "io/files/leftover_files.hpp"

namespace tetwarp {
namespace {
enum class SlotState { empty, changing, listed };

/// An entry of the list that a signal handler reads: fixed storage, valid when `state` is listed.
struct Slot {
  std::atomic<SlotState> state{SlotState::empty};
  std::array<char, 4096> name{};
};
static_assert(std::atomic<SlotState>::is_always_lock_free, "read by signal handlers");

std::array<Slot, 64> unfinished;

int list_name(const std::string& name) {
  if (name.size() >= unfinished[0].name.size()) return -1;
  for (std::size_t s = 0; s < unfinished.size(); ++s) {
    SlotState expected = SlotState::empty;
    if (!unfinished[s].state.compare_exchange_strong(expected, SlotState::changing)) continue;
    std::memcpy(unfinished[s].name.data(), name.c_str(), name.size() + 1);
    unfinished[s].state.store(SlotState::listed);
    return static_cast<int>(s);
  }
  return -1;
}

void unlist_name(int slot) {
  if (slot >= 0) unfinished[static_cast<std::size_t>(slot)].state.store(SlotState::empty);
}

std::string folder_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string::npos ? "" : path.substr(0, slash + 1);
}

/// Makes a folder and those above it. Throws IoError about `path`.
/// @returns those that were missing, the outermost first
std::vector<std::string> make_folders(const std::string& folder, const std::string& path) {
  namespace fs = std::filesystem;
  std::vector<std::string> missing;
  std::error_code error;
  for (fs::path above = folder; !above.empty() && !fs::exists(above, error);
       above = above.parent_path()) {
    if (above.has_filename()) missing.insert(missing.begin(), above.string());
    if (above == above.parent_path()) break;
  }
  std::vector<std::string> made;
  for (const std::string& name : missing) {
    if (mkdir(name.c_str(), 0777) == 0) {
      made.push_back(name);
    } else if (errno != EEXIST) {  // else another process was faster
      throw IoError(path, "",
                    "folder '" + name + "' cannot be made: " + std::strerror(errno) +
                        "; choose a folder that may be written to");
    }
  }
  return made;
}

std::string reason() {
  return std::strerror(errno);
}
}  // namespace

std::string link_target(const std::string& path) {
  std::string target = path;
  std::array<char, 4096> text{};
  for (int links = 0; links < 40; ++links) {
    const ssize_t size = readlink(target.c_str(), text.data(), text.size());
    if (size < 0 || size == std::ssize(text)) break;
    const std::string next(text.data(), static_cast<std::size_t>(size));
    target = next.starts_with('/') ? next : folder_of(target) + next;
  }
  return target;
}

FinishedFile::FinishedFile(const std::string& path) : path_(path), final_(link_target(path)) {
  static std::atomic<int> count{0};
  struct stat status {};
  if (stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode)) {
    throw IoError(path, "",
                  S_ISDIR(status.st_mode) ? "is a folder, give the name of a file"
                                          : "exists and is not a plain file, give another name");
  }
  const std::string folder = folder_of(final_);
  const std::string name = final_.substr(folder.size());
  if (name.empty()) throw IoError(path, "", "is not the name of a file");
  made_folders_ = make_folders(folder, path);
  remove_leftovers_once(folder);
  int descriptor = -1;
  do {
    temporary_ = folder + temporary_start() + std::to_string(count++) + ".tmp." + name;
    // Listed first: a signal may arrive as soon as the file exists.
    slot_ = list_name(temporary_);
    descriptor = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor < 0) unlist_name(slot_);
  } while (descriptor < 0 && errno == EEXIST);
  if (descriptor < 0) {
    throw IoError(path, "",
                  "cannot be created in folder '" + (folder.empty() ? "." : folder) +
                      "': " + reason() + "; choose a folder that exists and may be written to");
  }
  close(descriptor);
}

FinishedFile::~FinishedFile() {
  if (temporary_.empty()) return;
  unlink(temporary_.c_str());
  unlist_name(slot_);
  while (!made_folders_.empty()) {  // a folder that holds something stays
    rmdir(made_folders_.back().c_str());
    made_folders_.pop_back();
  }
}

std::int64_t FinishedFile::finish() {
  const int descriptor = open(temporary_.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  const bool is_flushed =
      descriptor >= 0 && fsync(descriptor) == 0 && fstat(descriptor, &status) == 0;
  const std::string problem = is_flushed ? "" : reason();
  if (descriptor >= 0) close(descriptor);
  if (!is_flushed) throw IoError(path_, "", "cannot be flushed: " + problem);
  if (rename(temporary_.c_str(), final_.c_str()) != 0) {
    throw IoError(path_, "", "cannot be moved from its temporary name: " + reason());
  }
  temporary_.clear();
  unlist_name(slot_);
  // Flushes the new name as well; a folder that cannot be flushed is not an error.
  const std::string folder = folder_of(final_);
  const int parent = open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_CLOEXEC);
  if (parent >= 0) {
    fsync(parent);
    close(parent);
  }
  return status.st_size;
}

std::int64_t write_finished_file(const std::string& path, std::string_view content) {
  FinishedFile file(path);
  const int descriptor = open(file.temporary().c_str(), O_WRONLY | O_CLOEXEC);
  if (descriptor < 0) throw IoError(path, "", "cannot be opened for writing: " + reason());
  while (!content.empty()) {
    const ssize_t written = write(descriptor, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      const std::string problem = reason();
      close(descriptor);
      throw IoError(path, "", "cannot be written: " + problem);
    }
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  close(descriptor);
  return file.finish();
}

void remove_unfinished_files() noexcept {
  for (const Slot& slot : unfinished) {
    if (slot.state.load() == SlotState::listed) unlink(slot.name.data());
  }
}

}  // namespace tetwarp

/// @file reader_program.cpp
/// Where tetwarp-read is, and how much a file may take.
#include "io/child/reader_program.hpp"

#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "io/files/numbered_files.hpp"

namespace tetwarp {
namespace {
namespace fs = std::filesystem;

/// Folder of the file that holds this code: the shared library, or a program with the static one.
fs::path own_folder() {
  static const char anchor = 0;
  Dl_info here{};
  fs::path file = dladdr(&anchor, &here) != 0 ? here.dli_fname : "";
  if (!file.is_absolute()) file = "/proc/self/exe";  // of a program it may be the name it was given
  std::error_code error;
  return fs::canonical(file, error).parent_path();
}

std::vector<fs::path> reader_places() {
  if (const char* const chosen = std::getenv("TETWARP_READER")) return {chosen};
  const fs::path folder = own_folder();
  return {folder / "tetwarp-read", (folder / TETWARP_READER_FROM_HERE).lexically_normal(),
          TETWARP_READER_INSTALLED};
}
}  // namespace

ChildLimits limits_for(const std::string& path, double time) {
  const double bytes = bytes_of_files(path);
  const double seconds = 120 + 5e-6 * bytes;
  const double memory = 0x1p32 + 1000 * bytes;
  return {time > 0 ? time : seconds, std::min(memory, available_memory())};
}

std::string find_reader(const std::string& path) {
  std::string searched;
  for (const fs::path& place : reader_places()) {
    if (access(place.c_str(), X_OK) == 0) return place;
    searched += (searched.empty() ? "" : ", ") + place.string();
  }
  throw IoError(path, "",
                "needs the program tetwarp-read, which is not at " + searched +
                    "; install it, or set TETWARP_READER to its path");
}

}  // namespace tetwarp

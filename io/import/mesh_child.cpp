/// @file mesh_child.cpp
/// Finds and starts tetwarp-read, and reads its message.
#include "io/import/mesh_child.hpp"

#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <tetwarp/error.hpp>
#include <utility>
#include <vector>

#include "io/files/memory.hpp"
#include "io/files/numbered_files.hpp"
#include "io/import/child_message.hpp"
#include "io/import/child_process.hpp"

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

/// Starts the program with words and has `receive` read its result.
template <class Receive>
void run_reader(const std::string& path,
                std::vector<std::string> words,
                const ChildLimits& limits,
                const Receive& receive) {
  words.insert(words.begin(), {find_reader(path), path, std::to_string(limits.memory)});
  std::string dataset, problem;
  try {
    ChildProcess child(std::move(words), limits.seconds);
    MessageReader message(child, available_memory());
    ChildOutcome outcome{};
    message(outcome);
    if (outcome == ChildOutcome::result) return receive(message);
    message(dataset);
    message(problem);
  } catch (const ChildError& error) {
    throw IoError(path, "",
                  std::string("its reader ") + error.what() +
                      ": the file is damaged or uses what the library cannot read; write it again");
  }
  throw IoError(path, dataset, problem);
}
}  // namespace

ChildLimits limits_for(const std::string& path, double time) {
  const double bytes = bytes_of_files(path);
  const double seconds = 120 + 5e-6 * bytes;
  const double memory = 0x1p32 + 1000 * bytes;
  return {time > 0 ? time : seconds, std::min(memory, available_memory())};
}

ImportedMesh read_mesh_in_child(const std::string& path,
                                const MeshImportOptions& options,
                                const ChildLimits& limits) {
  std::vector<std::string> words = {options.needs_solids ? "solids" : "triangles"};
  if (options.displacement) words.push_back(*options.displacement);
  ImportedMesh mesh;
  run_reader(path, std::move(words), limits,
             [&](auto& message) { exchange_members(message, mesh); });
  return mesh;
}

std::vector<Point3> read_points_in_child(const std::string& path) {
  std::vector<Point3> points;
  run_reader(path, {"points"}, limits_for(path), [&](auto& message) { message(points); });
  return points;
}

void place_points_in_child(const std::string& path,
                           const std::string& numbers,
                           const std::string& output) {
  run_reader(path, {"place", numbers, output}, limits_for(path), [](auto&) {});
}

}  // namespace tetwarp

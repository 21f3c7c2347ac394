/// @file fuzz_mesh.cpp
/// Usage: fuzz_mesh SECONDS SEED [FORMAT or FILE]
///
/// Damages meshes of other programs and imports them. A mesh or an IoError of one line passes; a
/// crash of this process, another exception or a crash of the project's code in the child that
/// reads fails. Crashes and hangs inside VTK and Gmsh are counted. Without a format all take turns.
#include <dlfcn.h>
#include <execinfo.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <tetwarp/error.hpp>
#include <vector>

#include "io/import/child_process.hpp"
#include "io/import/mesh_import.hpp"
#include "tests/io/fuzz_bytes.hpp"
#include "tests/io/fuzz_mesh_files.hpp"

namespace {
using namespace tetwarp;
using Clock = std::chrono::steady_clock;

constexpr double seconds_per_file = 10;
constexpr int max_failures = 10;

/// Where the child that reads crashed; shared with it.
enum class Place { nowhere, library, project };
volatile Place* crash_place = nullptr;
int trace_descriptor = -1;  ///< standard error of the parent; the child's is closed

struct Counts {
  long files = 0, read = 0, rejected = 0, library_crashes = 0, library_hangs = 0, failures = 0;
};

bool has(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

/// True for templates of the standard library, of which all libraries share one copy.
bool is_standard(const char* symbol) {
  const std::string name = symbol == nullptr ? "" : symbol;
  return name.starts_with("_ZNSt") || name.starts_with("_ZNKSt") || name.starts_with("_ZSt");
}

/// Attributes a crash to the first frame outside of the C and C++ libraries and the sanitizers.
void on_crash(int) {
  std::array<void*, 64> frames{};
  const int count = backtrace(frames.data(), static_cast<int>(frames.size()));
  Dl_info here{}, where{};
  dladdr(reinterpret_cast<void*>(&on_crash), &here);
  *crash_place = Place::library;
  for (int frame = 2; frame < count; ++frame) {
    if (dladdr(frames[static_cast<std::size_t>(frame)], &where) == 0) continue;
    const std::string object = where.dli_fname == nullptr ? "" : where.dli_fname;
    if (has(object, "libc.so") || has(object, "[vdso]") || has(object, "libasan") ||
        has(object, "libubsan") || has(object, "libstdc++") || has(object, "libgcc") ||
        is_standard(where.dli_sname)) {
      continue;
    }
    if (where.dli_fbase == here.dli_fbase) *crash_place = Place::project;
    break;
  }
  if (*crash_place == Place::project) backtrace_symbols_fd(frames.data(), count, trace_descriptor);
  _exit(1);
}

/// Reads without checks in a child whose crashes are attributed. @returns false for a crash of the
/// project's own code
bool reads_soundly(const std::string& path) {
  *crash_place = Place::nowhere;
  try {
    ChildProcess child({seconds_per_file, 0x1p31}, [&](ChildOutput& output) {
      for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGABRT, SIGILL}) {
        std::signal(signal, on_crash);
      }
      read_mesh_here(path, {});
      output.write("", 1);
    });
    char end = 0;
    child.read(&end, 1);
  } catch (const ChildError&) {
  }
  return *crash_place != Place::project;
}

/// Imports a file as a user does. @returns an empty text, or what is wrong
std::string import_once(const std::string& path, Counts& counts) {
  try {
    import_mesh(path, {.displacement = {}, .time_limit = seconds_per_file});
    ++counts.read;
  } catch (const IoError& error) {
    const std::string line = error.what();
    counts.library_crashes += has(line, "its reader crashed") || has(line, "without a result");
    counts.library_hangs += has(line, "its reader took");
    ++counts.rejected;
    if (has(line, "\n")) return "an error of several lines";
    if (has(line, "this build cannot read")) return "";
  } catch (const std::exception& error) {
    return error.what();
  }
  return reads_soundly(path) ? "" : "crash outside of VTK and Gmsh";
}

std::string content_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<test::ForeignMesh> chosen_meshes(const std::string& choice) {
  if (std::filesystem::exists(choice)) {
    return {{choice, std::filesystem::path(choice).filename().string(), content_of(choice)}};
  }
  std::vector<test::ForeignMesh> chosen;
  for (const test::ForeignMesh& mesh : test::foreign_meshes()) {
    if (choice.empty() || choice == mesh.format) chosen.push_back(mesh);
  }
  if (chosen.empty()) throw std::runtime_error(choice + ": no such format or file");
  return chosen;
}

/// Reads the undamaged files in this process, which also loads the libraries once for all children.
/// A build without the libraries reads none.
void read_good(const std::filesystem::path& folder, const std::vector<test::ForeignMesh>& meshes) {
  for (const test::ForeignMesh& mesh : meshes) {
    const std::string path = folder / mesh.name;
    std::ofstream(path, std::ios::binary) << mesh.content;
    try {
      if (read_mesh_here(path, {}).mesh.tets.empty()) throw IoError(path, "", "has no tetrahedra");
    } catch (const IoError& error) {
      if (!has(error.what(), "this build cannot read")) throw;
    }
  }
}

bool fuzz(int seconds, std::uint64_t seed, const std::string& choice) {
  std::string name = (std::filesystem::temp_directory_path() / "fuzz_mesh-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  const std::filesystem::path folder = name;
  const std::vector<test::ForeignMesh> meshes = chosen_meshes(choice);
  read_good(folder, meshes);
  Counts counts;
  const auto end = Clock::now() + std::chrono::seconds(seconds);
  for (std::uint64_t index = 0; Clock::now() < end && counts.failures < max_failures; ++index) {
    test::Random random(seed, index);
    const test::ForeignMesh& mesh = meshes[index % meshes.size()];
    std::string content = mesh.content;
    const std::size_t kind = random.below(3);
    if (kind != 0) test::damage_numbers(content, random);
    if (kind != 1) test::damage_bytes(content, random);
    const std::string path = folder / mesh.name;
    std::ofstream(path, std::ios::binary | std::ios::trunc) << content;
    ++counts.files;
    const std::string problem = import_once(path, counts);
    if (problem.empty()) continue;
    ++counts.failures;
    const auto kept =
        std::filesystem::temp_directory_path() /
        ("fuzz_mesh-" + std::to_string(seed) + "-" + std::to_string(index) + mesh.name);
    std::filesystem::copy_file(path, kept, std::filesystem::copy_options::overwrite_existing);
    std::printf("%s: %s\n", problem.c_str(), kept.c_str());
  }
  std::printf("%s: %ld files, %ld rejected, %ld read, %ld crashes and %ld hangs inside libraries\n",
              choice.empty() ? "all" : choice.c_str(), counts.files, counts.rejected, counts.read,
              counts.library_crashes, counts.library_hangs);
  std::filesystem::remove_all(folder);
  return counts.failures == 0;
}
}  // namespace

// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming): the sanitizers' names
extern "C" [[gnu::visibility("default")]] const char* __asan_default_options() {
  return "abort_on_error=1:detect_leaks=0:allocator_may_return_null=1";
}
extern "C" [[gnu::visibility("default")]] const char* __ubsan_default_options() {
  return "halt_on_error=1:abort_on_error=1";
}
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)

int main(int argc, char** argv) {
  if (argc < 3 || argc > 4) {
    std::fprintf(stderr, "usage: fuzz_mesh SECONDS SEED [FORMAT or FILE]\n");
    return 2;
  }
  void* const shared =
      mmap(nullptr, sizeof(Place), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) return 2;
  crash_place = static_cast<volatile Place*>(shared);
  trace_descriptor = dup(STDERR_FILENO);
  try {
    const std::string choice = argc == 4 ? argv[3] : "";
    return fuzz(std::atoi(argv[1]), static_cast<std::uint64_t>(std::atoll(argv[2])), choice) ? 0
                                                                                             : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}

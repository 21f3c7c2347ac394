/// @file fuzz_mesh_reader.cpp
/// tetwarp-read for fuzz_mesh: writes the call stack of a crash to a file.
#include <dlfcn.h>
#include <execinfo.h>
#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <string>

#include "io/reader/image_readers.hpp"
#include "io/reader/mesh_readers.hpp"
#include "io/reader/mesh_sender.hpp"

namespace {
bool has(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

/// True for templates of the standard library, of which all libraries share one copy.
bool is_standard(const char* symbol) {
  const std::string name = symbol == nullptr ? "" : symbol;
  return name.starts_with("_ZNSt") || name.starts_with("_ZNKSt") || name.starts_with("_ZSt");
}

/// Attributes a crash to the first frame outside of the C and C++ libraries and the sanitizers. If
/// that is code of the project, the file FUZZ_MESH_TRACE gets all frames.
void on_crash(int) {
  std::array<void*, 64> frames{};
  const int count = backtrace(frames.data(), static_cast<int>(frames.size()));
  Dl_info here{}, where{};
  dladdr(reinterpret_cast<void*>(&on_crash), &here);
  for (int frame = 2; frame < count; ++frame) {
    if (dladdr(frames[static_cast<std::size_t>(frame)], &where) == 0) continue;
    const std::string object = where.dli_fname == nullptr ? "" : where.dli_fname;
    if (has(object, "libc.so") || has(object, "[vdso]") || has(object, "libasan") ||
        has(object, "libubsan") || has(object, "libstdc++") || has(object, "libgcc") ||
        is_standard(where.dli_sname)) {
      continue;
    }
    if (where.dli_fbase != here.dli_fbase) break;
    const int trace = open(std::getenv("FUZZ_MESH_TRACE"), O_WRONLY | O_CREAT, 0600);
    backtrace_symbols_fd(frames.data(), count, trace);
    break;
  }
  _exit(1);
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
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGABRT, SIGILL}) {
    std::signal(signal, on_crash);
  }
  std::_Exit(tetwarp::send_result(
      argc, argv,
      {tetwarp::read_foreign_mesh, tetwarp::read_vtk_points, tetwarp::place_vtk_points,
       tetwarp::read_foreign_image, tetwarp::read_foreign_samples}));
}

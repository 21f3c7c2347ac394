/// @file mesh_sender.cpp
/// Limits of the process, and its message.
#include "io/reader/mesh_sender.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <new>
#include <tetwarp/missing_library.hpp>

#include "io/child/child_message.hpp"
#include "io/files/memory.hpp"
#include "io/import/mesh_child.hpp"

namespace tetwarp {
namespace {
/// Bytes of private writable memory that this process has mapped.
double mapped_memory() {
  std::ifstream file("/proc/self/statm");
  double pages = 0;
  for (int column = 0; column < 6; ++column) file >> pages;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

void set_limit(decltype(RLIMIT_DATA) resource, double value) {
  rlimit limit{};
  if (getrlimit(resource, &limit) != 0) return;
  const auto wanted = static_cast<rlim_t>(std::clamp(value, 0.0, 0x1p60));
  limit.rlim_cur = std::min(wanted, limit.rlim_max);
  setrlimit(resource, &limit);
}

/// Has the system end this process with the thread that started it.
/// @returns false when that one has ended already
bool end_with_caller() {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  pollfd output{STDOUT_FILENO, 0, 0};
  return poll(&output, 1, 0) == 0;
}

/// The standard output for the message alone: what libraries print goes to the standard error.
std::FILE* take_output() {
  const int descriptor = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  dup2(STDERR_FILENO, STDOUT_FILENO);
  return fdopen(descriptor, "wb");
}

void send_error(MessageWriter& message, const std::string& dataset, const std::string& problem) {
  message(ChildOutcome::error, dataset, problem);
}

/// The text of an error without the names of file and dataset, which its constructor adds.
std::string problem_of(const IoError& error) {
  const std::string names = IoError(error.file(), error.dataset(), "").what();
  return std::string(error.what()).substr(names.size());
}

/// Runs the function that the arguments name and sends its result.
void answer(MessageWriter& message,
            const std::vector<std::string>& words,
            const ReaderCalls& calls) {
  const std::string& path = words[0];
  const std::string& what = words[2];
  if (what == "points") {
    const std::vector<Point3> points = calls.points(path);
    message(ChildOutcome::result);
    message(points);
  } else if (what == "place") {
    calls.place(path, words.at(3), words.at(4));
    message(ChildOutcome::result);
  } else if (what == "coarsen") {
    const CoarseMesh mesh = calls.coarsen(path, std::stod(words.at(3)));
    message(ChildOutcome::result);
    message(mesh.points);
    message(mesh.triangles);
  } else if (what == "image") {
    const ForeignImage image = calls.image(path, words.at(3));
    message(ChildOutcome::result);
    message(image);
  } else if (what == "samples") {
    const auto send_image = [&](const ForeignImage& image) {
      message(ChildOutcome::result);
      message(image);
    };
    const auto send_slice = [&](const void* samples, std::size_t bytes) {
      message(ChildOutcome::result);  // an error may come in place of any slice
      message.write_bytes(samples, bytes);
    };
    calls.samples(path, words.at(3), words.at(4), send_image, send_slice);
  } else {
    MeshImportOptions options;
    options.needs_solids = what == "solids";
    if (words.size() > 3) options.displacement = words[3];
    ImportedMesh mesh = calls.mesh(path, options);
    message(ChildOutcome::result);
    exchange_members(message, mesh);
  }
}
}  // namespace

int send_result(int argc, char** argv, const ReaderCalls& calls) {
  if (argc < 4 || argc > 6) {
    std::fputs("tetwarp-read is started by tetwarp, to read meshes and images of other programs\n",
               stderr);
    return 2;
  }
  if (!end_with_caller()) return 1;
  const double memory = std::atof(argv[2]);
  set_limit(RLIMIT_CORE, 0);
  set_limit(RLIMIT_DATA, mapped_memory() + memory);
  std::FILE* const output = take_output();
  MessageWriter message(output);
  try {
    answer(message, {argv + 1, argv + argc}, calls);
  } catch (const MissingLibrary& error) {
    message(ChildOutcome::missing_library, error.library(), problem_of(error));
  } catch (const IoError& error) {
    send_error(message, error.dataset(), problem_of(error));
  } catch (const std::bad_alloc&) {
    send_error(message, "",
               "cannot be read in " + bytes_text(memory) +
                   " of memory: damaged, or too large for this machine");
  } catch (const std::exception& error) {
    send_error(message, "", std::string("cannot be read: ") + error.what());
  }
  return std::fflush(output) == 0 ? 0 : 1;
}

}  // namespace tetwarp

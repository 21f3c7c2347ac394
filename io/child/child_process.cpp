/// @file child_process.cpp
/// Starts the program, and reads its pipe.
#include "io/child/child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>

namespace tetwarp {
namespace {
constexpr std::size_t buffer_bytes = std::size_t{1} << 20;
constexpr int loader_exit_code = 127;  // of the system's loader, where a library is missing

/// @param output  becomes the standard output
/// @param process  out: the child
/// @returns an error code; 0: it runs
int start(std::vector<std::string>& words, int output, pid_t& process) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, output, STDOUT_FILENO);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  sigset_t all, none;
  sigfillset(&all);
  sigemptyset(&none);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setsigmask(&attributes, &none);
  const int error =
      posix_spawn(&process, arguments[0], &files, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  return error;
}
}  // namespace

ChildProcess::ChildProcess(std::vector<std::string> words, double seconds)
    : program_(words[0]),
      seconds_(seconds),
      deadline_(std::chrono::steady_clock::now() +
                std::chrono::milliseconds(static_cast<std::int64_t>(1000 * seconds))),
      buffer_(buffer_bytes) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) {
    throw std::runtime_error(std::string("no pipe to a child process: ") + std::strerror(errno));
  }
  descriptor_ = ends[0];
  const int error = start(words, ends[1], process_);
  close(ends[1]);
  if (error == 0) return;
  close(descriptor_);
  throw std::runtime_error("'" + program_ + "' cannot be started: " + std::strerror(error));
}

ChildProcess::~ChildProcess() {
  end();
  close(descriptor_);
}

void ChildProcess::read(void* bytes, std::size_t count) {
  auto* to = static_cast<std::byte*>(bytes);
  while (count > 0) {
    if (unread_.empty()) fill();
    const std::size_t part = std::min(count, unread_.size());
    std::memcpy(to, unread_.data(), part);
    unread_ = unread_.subspan(part);
    to += part;
    count -= part;
  }
}

void ChildProcess::fill() {
  using std::chrono::milliseconds;
  for (;;) {
    const auto left =
        std::chrono::duration_cast<milliseconds>(deadline_ - std::chrono::steady_clock::now());
    constexpr std::int64_t longest_wait = 60'000;
    pollfd waited{descriptor_, POLLIN, 0};
    const int ready =
        poll(&waited, 1, static_cast<int>(std::clamp<std::int64_t>(left.count(), 0, longest_wait)));
    if (ready == 0 && left.count() <= longest_wait) {
      throw ChildError("took more than " + std::to_string(static_cast<int>(seconds_)) + " s");
    }
    if (ready < 0 && errno != EINTR) throw ChildError(std::strerror(errno));
    if (ready <= 0) continue;
    const ssize_t got = ::read(descriptor_, buffer_.data(), buffer_.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) fail_at_end();
    unread_ = std::span(buffer_).first(static_cast<std::size_t>(got));
    return;
  }
}

void ChildProcess::fail_at_end() {
  const int status = end();
  if (WIFSIGNALED(status)) {
    throw ChildError(std::string("crashed (") + strsignal(WTERMSIG(status)) + ")");
  }
  if (WEXITSTATUS(status) == loader_exit_code) {
    throw std::runtime_error("'" + program_ +
                             "' lacks one of its libraries; run it by itself to see which");
  }
  throw ChildError("ended without a result");
}

/// Ends the child. @returns its status as of waitpid(); 0 where the program ignores SIGCHLD
int ChildProcess::end() {
  int status = 0;
  if (process_ <= 0) return status;
  kill(process_, SIGKILL);  // without effect on the status of a child that has ended
  while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
  return status;
}

}  // namespace tetwarp

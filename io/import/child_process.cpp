/// @file child_process.cpp
/// Forks, limits and isolates the child, and reads its pipe.
#include "io/import/child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>

namespace tetwarp {
namespace {
constexpr std::size_t buffer_bytes = std::size_t{1} << 20;
constexpr int failed_exit_code = 1;

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

/// Undoes what the child has inherited and should not have.
void isolate(const ChildLimits& limits, double inherited_memory, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(failed_exit_code);
  for (int signal = 1; signal < NSIG; ++signal) std::signal(signal, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  set_limit(RLIMIT_CORE, 0);
  set_limit(RLIMIT_DATA, inherited_memory + limits.memory);
  const int nothing = open("/dev/null", O_RDWR | O_CLOEXEC);
  for (int standard = 0; nothing >= 0 && standard < 3; ++standard) dup2(nothing, standard);
}

[[noreturn]] void run_child(int descriptor, const std::function<void(ChildOutput&)>& run) {
  try {
    ChildOutput output(descriptor);
    run(output);
    output.flush();
  } catch (...) {
    _exit(failed_exit_code);
  }
  _exit(0);
}
}  // namespace

void ChildOutput::write(const void* bytes, std::size_t count) {
  const auto* const from = static_cast<const std::byte*>(bytes);
  for (std::size_t done = 0; done < count;) {
    if (buffer_.size() == buffer_bytes) flush();
    const std::size_t part = std::min(count - done, buffer_bytes - buffer_.size());
    buffer_.insert(buffer_.end(), from + done, from + done + part);
    done += part;
  }
}

void ChildOutput::flush() {
  for (std::size_t done = 0; done < buffer_.size();) {
    const ssize_t put = ::write(descriptor_, buffer_.data() + done, buffer_.size() - done);
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) throw ChildError(std::strerror(errno));
    done += static_cast<std::size_t>(put);
  }
  buffer_.clear();
}

ChildProcess::ChildProcess(const ChildLimits& limits, const std::function<void(ChildOutput&)>& run)
    : limits_(limits),
      deadline_(std::chrono::steady_clock::now() +
                std::chrono::milliseconds(static_cast<std::int64_t>(1000 * limits.seconds))),
      buffer_(buffer_bytes) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) {
    throw std::runtime_error(std::string("no pipe to a child process: ") + std::strerror(errno));
  }
  const double inherited_memory = mapped_memory();
  const pid_t parent = getpid();
  process_ = fork();
  if (process_ == 0) {
    close(ends[0]);
    isolate(limits, inherited_memory, parent);
    run_child(ends[1], run);
  }
  const int error = errno;
  close(ends[1]);
  descriptor_ = ends[0];
  if (process_ > 0) return;
  close(descriptor_);
  throw std::runtime_error(std::string("no child process: ") + std::strerror(error));
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
      throw ChildError("took more than " + std::to_string(static_cast<int>(limits_.seconds)) +
                       " s");
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

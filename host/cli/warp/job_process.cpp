/// @file job_process.cpp
/// Starts the program again and waits for its end.
#include "host/cli/warp/job_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "host/cli/common/declare.hpp"

namespace tetwarp::cli {
namespace {
/// The lines of a text, without "tetwarp: ".
std::vector<std::string> lines_of(const std::string& text) {
  const std::string name = "tetwarp: ";
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    lines.push_back(one_line(line.starts_with(name) ? line.substr(name.size()) : line));
  }
  return lines;
}

/// A pipe whose first end is read without waiting.
class Pipe {
 public:
  Pipe() {
    if (pipe2(ends_.data(), O_CLOEXEC) != 0) {
      throw std::runtime_error(fmt::format("no pipe to a process: {}", std::strerror(errno)));
    }
    fcntl(ends_[0], F_SETFL, O_NONBLOCK);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    if (ends_[0] >= 0) close(ends_[0]);
    close(ends_[1]);
  }

  int write_end() const { return ends_[1]; }
  int take_read_end() { return std::exchange(ends_[0], -1); }  ///< to be closed by the caller

 private:
  std::array<int, 2> ends_{};
};
}  // namespace

JobProcess::JobProcess(const std::vector<std::string>& words) {
  std::vector<std::string> all = words;
  all.insert(all.begin(), "tetwarp");
  std::vector<char*> arguments;
  for (std::string& word : all) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  Pipe output, errors;
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&files, output.write_end(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, errors.write_end(), STDERR_FILENO);
  const int error =
      posix_spawn(&process_, "/proc/self/exe", &files, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (error != 0) {
    throw std::runtime_error(fmt::format("a process cannot be started: {}", std::strerror(error)));
  }
  output_.end = output.take_read_end();
  errors_.end = errors.take_read_end();
}

JobProcess::~JobProcess() {
  if (process_ > 0) {
    kill(process_, SIGTERM);
    while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  close(output_.end);
  close(errors_.end);
}

void JobProcess::interrupt() const {
  if (process_ > 0) kill(process_, SIGTERM);
}

void JobProcess::Stream::read_some() {
  char some[4096];
  for (ssize_t got = read(end, some, sizeof some); got > 0; got = read(end, some, sizeof some)) {
    text.append(some, static_cast<std::size_t>(got));
  }
}

void JobProcess::read_streams() {
  output_.read_some();
  errors_.read_some();
}

bool JobProcess::has_ended() {
  if (process_ <= 0) return true;
  read_streams();
  int status = 0;
  const pid_t ended = waitpid(process_, &status, WNOHANG);
  if (ended == 0 || (ended < 0 && errno == EINTR)) return false;
  process_ = -1;
  read_streams();
  end_.printed = lines_of(output_.text);
  end_.notes = lines_of(errors_.text);
  if (WIFSIGNALED(status)) {
    end_.exit_code = 128 + WTERMSIG(status);
    end_.problem =
        fmt::format("ended by signal {} ({}){}", WTERMSIG(status), strsignal(WTERMSIG(status)),
                    WTERMSIG(status) == SIGKILL ? "; the machine may lack memory" : "");
  } else {
    end_.exit_code = WEXITSTATUS(status);
    if (end_.exit_code == 0 || end_.notes.empty()) return true;
    end_.problem = end_.notes.back();
    end_.notes.pop_back();
  }
  return true;
}

}  // namespace tetwarp::cli

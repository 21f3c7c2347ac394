/// @file job_process.cpp
/// Starts the program again and waits for its end.
#include "host/cli/warp/job_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>

#include "host/cli/common/declare.hpp"

namespace tetwarp::cli {
namespace {
/// The last line of a text, without "tetwarp: ".
std::string last_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  text.erase(0, text.rfind('\n') + 1);
  const std::string name = "tetwarp: ";
  return one_line(text.starts_with(name) ? text.substr(name.size()) : text);
}
}  // namespace

JobProcess::JobProcess(const std::vector<std::string>& words) {
  std::vector<std::string> all = words;
  all.insert(all.begin(), "tetwarp");
  std::vector<char*> arguments;
  for (std::string& word : all) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) {
    throw std::runtime_error(fmt::format("no pipe to a process: {}", std::strerror(errno)));
  }
  errors_ = ends[0];
  fcntl(errors_, F_SETFL, O_NONBLOCK);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&files, ends[1], STDERR_FILENO);
  const int error =
      posix_spawn(&process_, "/proc/self/exe", &files, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  close(ends[1]);
  if (error == 0) return;
  close(errors_);
  throw std::runtime_error(fmt::format("a process cannot be started: {}", std::strerror(error)));
}

JobProcess::~JobProcess() {
  if (process_ > 0) {
    kill(process_, SIGTERM);
    while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  close(errors_);
}

void JobProcess::interrupt() const {
  if (process_ > 0) kill(process_, SIGTERM);
}

void JobProcess::read_errors() {
  char some[4096];
  for (ssize_t got = read(errors_, some, sizeof some); got > 0;
       got = read(errors_, some, sizeof some)) {
    text_.append(some, static_cast<std::size_t>(got));
  }
}

bool JobProcess::has_ended() {
  if (process_ <= 0) return true;
  read_errors();
  int status = 0;
  const pid_t ended = waitpid(process_, &status, WNOHANG);
  if (ended == 0 || (ended < 0 && errno == EINTR)) return false;
  process_ = -1;
  read_errors();
  if (WIFSIGNALED(status)) {
    end_.exit_code = 128 + WTERMSIG(status);
    end_.problem =
        fmt::format("ended by signal {} ({}){}", WTERMSIG(status), strsignal(WTERMSIG(status)),
                    WTERMSIG(status) == SIGKILL ? "; the machine may lack memory" : "");
  } else {
    end_.exit_code = WEXITSTATUS(status);
    if (end_.exit_code != 0) end_.problem = last_line(text_);
  }
  return true;
}

}  // namespace tetwarp::cli

/// @file running_scene.hpp
/// Commands that are watched while they run: files that appear, a terminal.
#pragma once
#include <fcntl.h>
#include <poll.h>
#include <sys/inotify.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/cli_scene.hpp"

namespace tetwarp::test {

/// Replaces the mesh of a scene by one with so many steps that the command still runs when its
/// first file exists.
inline void write_long_mesh(const Scene& scene, std::size_t steps = 20000) {
  std::vector<double> voxels(steps);
  for (std::size_t s = 0; s < voxels.size(); ++s) voxels[s] = 1e-4 * static_cast<double>(s);
  write_mesh(scene / "mesh.vtkhdf", box_mesh(), shifts(voxels), voxels);
}

/// Watches a folder for the first file that is created after construction.
class FolderWatch {
 public:
  explicit FolderWatch(const TemporaryFolder& folder) : notifier_(inotify_init()) {
    inotify_add_watch(notifier_, folder.path().c_str(), IN_CREATE);
  }
  ~FolderWatch() { close(notifier_); }
  FolderWatch(const FolderWatch&) = delete;
  FolderWatch& operator=(const FolderWatch&) = delete;

  /// Waits for that file; false after half a minute.
  bool sees_new_file() const {
    pollfd events{notifier_, POLLIN, 0};
    return poll(&events, 1, 30'000) == 1;
  }

 private:
  int notifier_;
};

/// A terminal whose name can be opened as the standard error of a command.
class Terminal {
 public:
  explicit Terminal(unsigned short columns) : reader_(posix_openpt(O_RDWR | O_NOCTTY)) {
    if (reader_ < 0 || grantpt(reader_) != 0 || unlockpt(reader_) != 0) {
      throw std::runtime_error("no terminal");
    }
    name_ = ptsname(reader_);
    keep_open_ = open(name_.c_str(), O_RDWR | O_NOCTTY);  // else the reader fails between writers
    const winsize size{25, columns, 0, 0};
    ioctl(reader_, TIOCSWINSZ, &size);
  }
  ~Terminal() {
    close(keep_open_);
    close(reader_);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  const std::string& name() const { return name_; }

  /// Everything that was written so far, after waiting until it contains `words`, at most 30 s.
  const std::string& wait_for(const std::string& words) {
    while (text_.find(words) == std::string::npos && take(30'000)) {
    }
    return text_;
  }

  /// Everything that is written until a command ends.
  const std::string& text_until_end_of(const RunningCommand& command) {
    siginfo_t ended{};
    while (waitid(P_PID, static_cast<id_t>(command.process()), &ended,
                  WEXITED | WNOHANG | WNOWAIT) == 0 &&
           ended.si_pid == 0) {
      take(100);
    }
    return text();
  }

  /// Everything that was written so far.
  const std::string& text() {
    while (take(0)) {
    }
    return text_;
  }

 private:
  bool take(int milliseconds) {
    pollfd events{reader_, POLLIN, 0};
    if (poll(&events, 1, milliseconds) != 1) return false;
    std::array<char, 4096> part{};
    const ssize_t size = read(reader_, part.data(), part.size());
    if (size <= 0) return false;
    text_.append(part.data(), static_cast<std::size_t>(size));
    return true;
  }

  int reader_;
  int keep_open_ = -1;
  std::string name_;
  std::string text_;
};

}  // namespace tetwarp::test

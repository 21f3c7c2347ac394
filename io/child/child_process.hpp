/// @file child_process.hpp
/// A program that runs as a child process, so that a crash, an endless loop or unbounded memory in
/// a foreign library ends the child and not this program.
#pragma once
#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace tetwarp {

/// A child that did not deliver its result. `what()` says how it ended, without the file's name.
class ChildError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A child process and the bytes that it writes to its standard output. Its standard input and
/// error are /dev/null, and its signals have their default actions.
class ChildProcess {
 public:
  /// @param words    path of the program, and its arguments
  /// @param seconds  from the start to the last byte of the result
  /// @throws std::runtime_error when the program cannot be started
  ChildProcess(std::vector<std::string> words, double seconds);
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  ~ChildProcess();  ///< kills the child and waits for its end

  /// Waits for the next bytes of the result. Throws ChildError when the child ends before it has
  /// sent them, or exceeds its time, and std::runtime_error when it lacks a library.
  void read(void* bytes, std::size_t count);

 private:
  void fill();
  [[noreturn]] void fail_at_end();
  int end();

  std::string program_;
  double seconds_;
  std::chrono::steady_clock::time_point deadline_;
  pid_t process_ = -1;
  int descriptor_ = -1;
  std::vector<std::byte> buffer_;
  std::span<const std::byte> unread_;
};

}  // namespace tetwarp

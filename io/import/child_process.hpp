/// @file child_process.hpp
/// A function that runs in a child process, so that a crash, an endless loop or unbounded memory in
/// a foreign library ends the child and not the program.
#pragma once
#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <functional>
#include <span>
#include <stdexcept>
#include <vector>

namespace tetwarp {

/// A child that did not deliver its result. `what()` says how it ended, without the file's name.
class ChildError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct ChildLimits {
  double seconds;  ///< from the start to the last byte of the result
  double memory;   ///< [byte] that the child may allocate
};

/// The end of a pipe to which a child writes its result.
class ChildOutput {
 public:
  explicit ChildOutput(int descriptor) : descriptor_(descriptor) {}

  /// Throws ChildError when nobody reads.
  void write(const void* bytes, std::size_t count);
  void flush();

 private:
  int descriptor_;
  std::vector<std::byte> buffer_;
};

/// A child process and the bytes that it sends.
///
/// The child is made by fork() without exec(): it has one thread, the caller's. Its standard input
/// and outputs are /dev/null, its signal handlers are the default ones, it leaves no core file, it
/// runs no exit handlers and it is killed with the thread that made it.
class ChildProcess {
 public:
  /// @param run  runs in the child; its exceptions end the child
  /// @throws std::runtime_error when no process can be made
  ChildProcess(const ChildLimits& limits, const std::function<void(ChildOutput&)>& run);
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  ~ChildProcess();  ///< kills the child and waits for its end

  /// Waits for the next bytes of the result. Throws ChildError when the child ends before it has
  /// sent them, or exceeds its time.
  void read(void* bytes, std::size_t count);

 private:
  void fill();
  [[noreturn]] void fail_at_end();
  int end();

  ChildLimits limits_;
  std::chrono::steady_clock::time_point deadline_;
  pid_t process_ = -1;
  int descriptor_ = -1;
  std::vector<std::byte> buffer_;
  std::span<const std::byte> unread_;
};

}  // namespace tetwarp

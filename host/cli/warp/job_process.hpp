/// @file job_process.hpp
/// A job of a batch as a process of its own, beside other jobs.
#pragma once
#include <sys/types.h>

#include <string>
#include <vector>

namespace tetwarp::cli {

/// How a process has ended.
struct ProcessEnd {
  int exit_code = 0;    ///< of a process that a signal has ended 128 and its number
  std::string problem;  ///< its last line on standard error, or the signal; empty after exit code 0
};

/// This program, started with other words. Its standard output is dropped.
class JobProcess {
 public:
  /// @param words  without the name of the program
  /// @throws std::runtime_error when it cannot be started
  explicit JobProcess(const std::vector<std::string>& words);
  JobProcess(const JobProcess&) = delete;
  JobProcess& operator=(const JobProcess&) = delete;
  ~JobProcess();  ///< ends the process and waits for it

  /// Whether it has ended. Does not wait.
  bool has_ended();

  /// @pre has_ended()
  const ProcessEnd& end() const { return end_; }

  void interrupt() const;  ///< sends it SIGTERM

 private:
  void read_errors();

  pid_t process_ = -1;
  int errors_ = -1;  ///< its standard error, read without waiting
  std::string text_;
  ProcessEnd end_;
};

}  // namespace tetwarp::cli

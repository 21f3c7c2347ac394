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
  std::vector<std::string> notes;    ///< the other lines there, without "tetwarp: "
  std::vector<std::string> printed;  ///< lines on standard output
};

/// This program, started with other words.
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
  /// What a process prints, read without waiting.
  struct Stream {
    int end = -1;
    std::string text;
    void read_some();
  };

  void read_streams();

  pid_t process_ = -1;
  Stream output_;
  Stream errors_;
  ProcessEnd end_;
};

}  // namespace tetwarp::cli

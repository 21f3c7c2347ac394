/// @file progress_bar.hpp
/// Progress of a series of steps on a terminal.
#pragma once
#include <chrono>
#include <string>

namespace tetwarp::cli {

/// One line on standard error, redrawn at most ten times a second and cleared by the destructor:
/// share done, Mvoxel/s, steps/s, remaining time. Draws only to a terminal.
class ProgressBar {
 public:
  /// @param is_enabled false: never draw
  /// @param label       shown first, e.g. "warp" or "job 3"
  /// @param step_count  steps of the whole job
  ProgressBar(bool is_enabled, std::string label, double step_count);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// @param steps_done   steps finished, with the finished share of the current one
  /// @param voxels_done  output voxels computed so far
  void update(double steps_done, double voxels_done);

 private:
  using Clock = std::chrono::steady_clock;

  bool draws_;
  std::string label_;
  double step_count_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point drawn_{};
};

/// "42 s", "3 min 05 s", "2 h 10 min".
std::string duration_text(double seconds);

}  // namespace tetwarp::cli

/// @file progress_bar.hpp
/// Progress of a series of steps on a terminal.
#pragma once
#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

namespace tetwarp::cli {

/// What a progress bar shows.
struct ProgressState {
  std::string label;        ///< shown first, e.g. "warp" or "job 3"
  double share = 0;         ///< of the work that is done, 0 to 1
  double step = 1;          ///< number of the current step, from 1
  double step_count = 1;    ///< steps of the whole job
  double voxel_rate = 0;    ///< output voxels per second
  double seconds_left = 0;  ///< negative: not known yet
  std::string note;         ///< shown in place of the rate, e.g. simulated time; empty: the rate
  std::string phase;        ///< shown instead of the remaining time; empty: computing
};

/// The line of a progress bar, at most `width` characters. Where it does not fit, the bar is
/// shortened, then the rate is left out.
std::string progress_line(const ProgressState& state, std::size_t width);

/// One line on standard error, redrawn at most ten times a second and cleared by the destructor:
/// share done, Mvoxel/s, remaining time. Never runs backwards. Draws only to a terminal, within its
/// width, and not after an interrupt.
class ProgressBar {
 public:
  /// @param is_enabled  false: never draw
  /// @param label       shown first, e.g. "warp" or "job 3"
  /// @param step_work   work of each step of the job in the order in which they are computed, in
  ///                    units that take equal time
  ProgressBar(bool is_enabled, std::string label, std::vector<double> step_work);
  /// The same for steps that take equal time; their number may be large.
  ProgressBar(bool is_enabled, std::string label, std::size_t step_count);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// @param steps_done   steps since the last finish_step(), with the share of the current one
  /// @param voxels_done  output voxels computed so far
  void update(double steps_done, double voxels_done);

  /// One more step is computed and written.
  void finish_step() { ++finished_; }

  /// The next steps need no work: --resume keeps them.
  void skip_steps(std::size_t count);

  /// Shows a text in place of the rate from the next update on.
  void show_note(const std::string& note) { state_.note = note; }

  /// Shows what is done while no share is reported, e.g. "writing"; until the next update.
  void show_phase(const std::string& phase);

 private:
  using Clock = std::chrono::steady_clock;

  double work_before(double step) const;
  void draw();

  bool draws_;
  ProgressState state_;
  std::vector<double> step_work_;  ///< empty: 1 each
  std::size_t finished_ = 0;       ///< steps, skipped ones included
  double work_ = 0;                ///< done
  double voxels_ = 0;              ///< done
  bool has_begun_ = false;         ///< update() has been called
  double work_at_begin_ = 0;       ///< of the first update(), from which rates are measured
  double voxels_at_begin_ = 0;     ///< likewise
  Clock::time_point begin_{};      ///< likewise
  Clock::time_point drawn_{};
};

/// "42 s", "3 min 05 s", "2 h 10 min".
std::string duration_text(double seconds);

}  // namespace tetwarp::cli

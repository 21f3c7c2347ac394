/// @file progress_bar.cpp
/// The text of the bar, and when it is drawn.
#include "host/cli/common/progress_bar.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "host/cli/common/interrupt.hpp"

namespace tetwarp::cli {
namespace {
constexpr auto redraw_interval = std::chrono::milliseconds(100);

/// Columns of the terminal, 80 if they are not known.
std::size_t terminal_width() {
  winsize size{};
  const bool is_known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return is_known ? size.ws_col : 80;
}
}  // namespace

std::string progress_line(const ProgressState& state, std::size_t width) {
  const double share = std::clamp(state.share, 0.0, 1.0);
  // 100 % is not shown before the files are written.
  const int percent = std::min(static_cast<int>(100 * share), 99);
  const std::string step = fmt::format(" {:2}%  step {:.0f} of {:.0f}", percent,
                                       std::min(state.step, state.step_count), state.step_count);
  const double rate_millions = 1e-6 * state.voxel_rate;
  const std::string rate = !state.note.empty() ? "  " + state.note
                           : rate_millions > 0 ? fmt::format("  {:.{}f} Mvoxel/s", rate_millions,
                                                             rate_millions < 10 ? 1 : 0)
                                               : "";
  std::string end;
  if (!state.phase.empty()) {
    end = "  " + state.phase;
  } else if (state.seconds_left >= 0) {
    end = "  " + duration_text(state.seconds_left) + " left";
  }
  std::string line;
  for (const auto& [bar, middle] :
       {std::pair(24, rate), {12, rate}, {24, std::string()}, {12, std::string()}}) {
    const std::string filled(static_cast<std::size_t>(share * bar), '#');
    line = fmt::format("{} [{:-<{}}]{}{}{}", state.label, filled, bar, step, middle, end);
    if (line.size() <= width) return line;
  }
  return line.substr(0, width);
}

ProgressBar::ProgressBar(bool is_enabled, std::string label, std::vector<double> step_work)
    : draws_(is_enabled && isatty(STDERR_FILENO) == 1), step_work_(std::move(step_work)) {
  state_.label = std::move(label);
  state_.step_count = std::max<double>(1, static_cast<double>(step_work_.size()));
}

ProgressBar::ProgressBar(bool is_enabled, std::string label, std::size_t step_count)
    : ProgressBar(is_enabled, std::move(label), std::vector<double>()) {
  state_.step_count = std::max<double>(1, static_cast<double>(step_count));
}

ProgressBar::~ProgressBar() {
  if (draws_ && !is_interrupted()) std::fputs("\r\033[K", stderr);
}

void ProgressBar::update(double steps_done, double voxels_done) {
  if (!draws_ || (has_begun_ && Clock::now() - drawn_ < redraw_interval)) return;
  state_.phase.clear();
  const double step = static_cast<double>(finished_) + steps_done;
  work_ = std::max(work_, work_before(step));
  voxels_ = std::max(voxels_, voxels_done);
  state_.step = std::max(state_.step, std::floor(step) + 1);
  if (!std::exchange(has_begun_, true)) {
    begin_ = Clock::now();
    work_at_begin_ = work_;
    voxels_at_begin_ = voxels_;
  }
  draw();
}

void ProgressBar::skip_steps(std::size_t count) {
  if (step_work_.empty()) finished_ += count;
  for (; count > 0 && finished_ < step_work_.size(); --count) step_work_[finished_++] = 0;
}

void ProgressBar::show_phase(const std::string& phase) {
  if (!draws_) return;
  state_.phase = phase;
  draw();
}

/// Work of the steps before a step, which may be a fraction.
double ProgressBar::work_before(double step) const {
  if (step_work_.empty()) return std::clamp(step, 0.0, state_.step_count);
  double work = 0;
  for (std::size_t s = 0; s < step_work_.size(); ++s) {
    work += std::clamp(step - static_cast<double>(s), 0.0, 1.0) * step_work_[s];
  }
  return work;
}

void ProgressBar::draw() {
  if (is_interrupted()) return;
  drawn_ = Clock::now();
  const double all = work_before(state_.step_count);
  const double seconds = has_begun_ ? std::chrono::duration<double>(drawn_ - begin_).count() : 0;
  const double worked = work_ - work_at_begin_;
  state_.share = std::max(state_.share, all > 0 ? work_ / all : 0);
  state_.voxel_rate = seconds > 0 ? (voxels_ - voxels_at_begin_) / seconds : 0;
  state_.seconds_left = worked > 0 ? seconds * (all - work_) / worked : -1;
  std::fputs(("\r\033[K" + progress_line(state_, terminal_width() - 1)).c_str(), stderr);
  std::fflush(stderr);
}

std::string duration_text(double seconds) {
  const auto whole = static_cast<long>(std::ceil(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

}  // namespace tetwarp::cli

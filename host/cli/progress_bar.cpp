#include "host/cli/progress_bar.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace tetwarp::cli {
namespace {
constexpr int bar_width = 24;
constexpr auto redraw_interval = std::chrono::milliseconds(100);
}  // namespace

ProgressBar::ProgressBar(bool is_enabled, std::string label, double step_count)
    : draws_(is_enabled && isatty(STDERR_FILENO) == 1),
      label_(std::move(label)),
      step_count_(std::max(step_count, 1.0)) {}

ProgressBar::~ProgressBar() {
  if (draws_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::update(double steps_done, double voxels_done) {
  const Clock::time_point now = Clock::now();
  if (!draws_ || now - drawn_ < redraw_interval) return;
  drawn_ = now;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  const double share = std::clamp(steps_done / step_count_, 0.0, 1.0);
  const double rate = 1 / std::max(seconds, 1e-3);
  std::string line =
      fmt::format("\r\033[K{} [{:-<{}}] {:3.0f}%  step {:.0f} of {:.0f}", label_,
                  std::string(static_cast<std::size_t>(share * bar_width), '#'), bar_width,
                  100 * share, std::min(std::floor(steps_done) + 1, step_count_), step_count_);
  line += fmt::format("  {:.0f} Mvoxel/s  {:.2f} steps/s", 1e-6 * voxels_done * rate,
                      steps_done * rate);
  if (share > 0) line += "  " + duration_text(seconds / share * (1 - share)) + " left";
  std::fputs(line.c_str(), stderr);
  std::fflush(stderr);
}

std::string duration_text(double seconds) {
  const auto whole = static_cast<long>(std::ceil(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

}  // namespace tetwarp::cli

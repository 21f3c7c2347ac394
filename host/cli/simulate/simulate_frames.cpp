/// @file simulate_frames.cpp
/// Numbers of frames and steps, and names that are unique.
#include "host/cli/simulate/simulate_frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <utility>

namespace tetwarp::cli {
namespace {
/// `name`, with a number where it is taken.
std::string unused(const std::string& name, std::set<std::string>& used) {
  std::string unique = name;
  for (int n = 2; !used.insert(unique).second; ++n) unique = fmt::format("{}_{}", name, n);
  return unique;
}
}  // namespace

FrameSteps::FrameSteps(const SceneOutput& output, double time_step, std::int64_t step_count)
    : interval_(std::max(
          1.0, output.every ? static_cast<double>(*output.every) : 1 / (output.rate * time_step))),
      step_count_(step_count) {
  const double regular = std::floor((static_cast<double>(step_count) + 0.5) / interval_);
  auto last = static_cast<std::int64_t>(regular);
  while (last > 0 && std::llround(static_cast<double>(last) * interval_) > step_count) --last;
  const bool ends_regularly = std::llround(static_cast<double>(last) * interval_) == step_count;
  count_ = last + (ends_regularly ? 1 : 2);
}

std::int64_t FrameSteps::step_of(std::int64_t frame) const {
  if (frame + 1 >= count_) return step_count_;
  return std::llround(static_cast<double>(frame) * interval_);
}

std::int64_t FrameSteps::count_through(std::int64_t step) const {
  if (step < 0) return 0;
  if (step >= step_count_) return count_;
  auto frame = static_cast<std::int64_t>((static_cast<double>(step) + 0.5) / interval_);
  frame = std::min(frame, count_ - 1);
  while (frame > 0 && step_of(frame) > step) --frame;
  while (frame + 1 < count_ && step_of(frame + 1) <= step) ++frame;
  return frame + 1;
}

std::vector<std::string> older_frames(const std::vector<std::string>& written, std::int64_t next) {
  std::set<std::pair<std::string, std::string>> kinds;  // of names: before and behind the number
  for (const std::string& path : written) {
    kinds.emplace(path.substr(0, path.rfind('_') + 1), path.substr(path.rfind('.')));
  }
  std::vector<std::string> warnings;
  for (const auto& [head, tail] : kinds) {
    const auto name = [&](std::int64_t n) { return fmt::format("{}{:04}{}", head, n, tail); };
    std::int64_t n = next;
    while (std::filesystem::exists(name(n))) ++n;
    if (n == next) continue;
    warnings.push_back(
        fmt::format("{}: is of an earlier run, as are {} of the names that follow; remove them",
                    name(next), n - next - 1));
  }
  return warnings;
}

std::vector<std::string> coupling_names(const Scene& scene) {
  std::set<std::string> used;
  std::vector<std::string> names;
  for (const Coupling& coupling : scene.couplings) {
    const std::string name = coupling.name.empty() ? coupling.a + "-" + coupling.b : coupling.name;
    names.push_back(unused(name, used));
  }
  return names;
}

std::vector<std::string> obstacle_names(const Scene& scene) {
  std::set<std::string> used;
  std::vector<std::string> names;
  for (std::size_t o = 0; o < scene.obstacles.size(); ++o) {
    const std::string& name = scene.obstacles[o].name;
    names.push_back(unused(name.empty() ? fmt::format("obstacle{}", o) : name, used));
  }
  return names;
}

}  // namespace tetwarp::cli

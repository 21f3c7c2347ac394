/// @file live_start.cpp
/// Options of a simulator, and its first state.
#include "host/view/live_start.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <tetwarp/error.hpp>
#include <tetwarp/names.hpp>

#include "io/files/text_file.hpp"

namespace tetwarp::view {
namespace {
bool has_handle(const Scene& scene) {
  return std::ranges::count(scene.handles, handle_name, &Handle::name) > 0;
}

/// @throws IoError  it is no checkpoint of this scene
void restore(const std::string& file, Simulator& simulator) {
  const std::string bytes = read_text(file);
  try {
    simulator.restore(std::as_bytes(std::span(bytes)));
  } catch (const std::invalid_argument& error) {
    throw IoError(file, "", error.what());
  }
}
}  // namespace

bool has_limits(const std::optional<InputLog>& replay) {
  return replay && std::ranges::count(replay->events, InputKind::limit, &InputEvent::kind) > 0;
}

SimulateOptions simulate_options(const ViewOptions& of, const std::optional<InputLog>& replay) {
  SimulateOptions options;
  for (const EnumName<Backend>& entry : names_of<Backend>()) {
    if (entry.name == of.backend) options.backend = entry.value;
  }
  options.device = static_cast<int>(of.device);
  options.threads = static_cast<int>(of.threads);
  options.max_step_seconds = of.max_step_seconds;
  options.untangle = of.untangle;
  const bool is_limited = std::isfinite(of.max_step_seconds) && !of.record.empty();
  if (!is_limited && !has_limits(replay)) return options;
  if (of.threads > 1 || options.backend == Backend::cuda) {
    throw std::invalid_argument(
        "steps that --max-step-seconds ended are recorded and repeated by one thread of the back "
        "end cpu; leave --threads and --backend out");
  }
  options.threads = 1;
  if (has_limits(replay)) options.max_step_seconds = 1;  // not asked: steps end at counts
  return options;
}

void check_start(const ViewOptions& options,
                 std::uint64_t start,
                 const std::optional<InputLog>& replay) {
  if (!replay || replay->start == start) return;
  throw IoError(options.replay, "",
                "was recorded with another scene or start than " + options.scene_words() +
                    "; view what it was recorded with, unchanged: " + replay->scene);
}

std::vector<std::byte> first_state(const ViewOptions& options, Simulator& simulator) {
  if (!options.restart.empty()) {
    const bool is_of_scene = has_handle(simulator.scene());
    restore(options.restart, simulator);
    if (!is_of_scene && has_handle(simulator.scene())) simulator.release_handle(handle_name);
  }
  return simulator.checkpoint();
}

}  // namespace tetwarp::view

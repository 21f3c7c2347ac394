/// @file main.cpp
/// The program tetwarp-view, which `tetwarp view` starts: tetwarp-view NAME=VALUE...
#include <X11/Xlib.h>

#include <algorithm>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <optional>
#include <stdexcept>
#include <string>
#include <tetwarp/error.hpp>
#include <tetwarp/scene_io.hpp>
#include <utility>
#include <vector>

#include "host/base/stopwatch.hpp"
#include "host/view/live_simulation.hpp"
#include "host/view/view_options.hpp"
#include "host/view/view_scene.hpp"
#include "host/view/view_tools.hpp"
#include "host/view/window/screens.hpp"
#include "host/view/window/view_window.hpp"
#include "io/files/finished_file.hpp"
#include "io/files/input_check.hpp"

namespace tetwarp::view {
namespace {

/// VTK aborts without a display.
void check_display() {
  Display* const display = XOpenDisplay(nullptr);
  if (display != nullptr) {
    XCloseDisplay(display);
    return;
  }
  const char* const name = std::getenv("DISPLAY");
  throw std::runtime_error((name == nullptr || *name == 0
                                ? std::string("there is no display (DISPLAY is not set)")
                                : "display '" + std::string(name) + "' cannot be opened") +
                           "; start it from a desktop, through ssh -X, or within xvfb-run");
}

/// The scene, with tools. Results are not written to the files that it names.
Scene load(const ViewOptions& options) {
  std::vector<std::string> inputs;
  Scene scene = options.scene_file.empty()
                    ? parse_scene(scene_text(options.scene_name), options.scene_name)
                    : read_scene(options.scene_file, &inputs);
  for (const std::string& output : options.outputs()) check_no_input(output, inputs);
  add_tools(options, scene);
  return scene;
}

std::optional<InputLog> replay_of(const ViewOptions& options) {
  if (options.replay.empty()) return std::nullopt;
  return read_input_log(options.replay);
}

void write_results(LiveSimulation& simulation, const ViewOptions& options) {
  if (!options.record.empty()) write_finished_file(options.record, text_of(simulation.log()));
  if (options.checkpoint.empty()) return;
  const std::vector<std::byte> bytes = simulation.checkpoint();
  write_finished_file(options.checkpoint,
                      {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

/// @param wall  since the simulation began [s]
void print_timing(const LiveSimulation& simulation, const ViewWindow& window, double wall) {
  const LiveSeconds& spent = simulation.seconds();
  const auto each = [](double seconds, std::int64_t count) {
    return 1000 * seconds / static_cast<double>(std::max<std::int64_t>(count, 1));
  };
  std::printf(
      "processor time: %lld steps of %.2f ms, %lld warps of %.2f ms, %lld pictures of %.2f ms\n",
      static_cast<long long>(simulation.log().ticks), each(spent.steps, simulation.log().ticks),
      static_cast<long long>(spent.warp_count), each(spent.warps, spent.warp_count),
      static_cast<long long>(window.pictures().count()), 1000 * window.pictures().seconds());
  std::printf("wall time: %.1f steps/s in %.1f s, %lld over their time; %.1f pictures/s\n",
              static_cast<double>(simulation.log().ticks) / wall, wall,
              static_cast<long long>(simulation.late_steps()), window.pictures().rate());
}

volatile std::sig_atomic_t signal_number = 0;

extern "C" void note_signal(int signal) {
  signal_number = signal;
}

/// A signal ends it as Ctrl and q do.
void take_signals() {
  std::signal(SIGINT, note_signal);
  std::signal(SIGTERM, note_signal);
}

void show_scene(const ViewOptions& options) {
  std::optional<InputLog> replay = replay_of(options);
  Scene loaded = load(options);
  std::optional<LiveSimulation> simulation;
  try {
    simulation.emplace(std::move(loaded), options, std::move(replay));
  } catch (const std::invalid_argument& error) {
    throw IoError(options.scene(), "", error.what());
  }
  const ViewScene scene = view_scene_of(*simulation, options);
  std::optional<MasterScreens> screens;
  if (!options.screens.empty()) screens.emplace(*simulation, scene, options);
  ViewWindow window(scene, *simulation, options, screens ? &*screens : nullptr);
  take_signals();
  if (screens) screens->wait_for_screens();
  const Stopwatch since_start;
  simulation->begin();
  window.run(signal_number);
  const std::string problem = window.failure();
  simulation->end();
  const double wall = since_start.seconds();
  write_results(*simulation, options);
  if (!options.screenshot.empty() && window.has_picture()) window.save_picture(options.screenshot);
  if (options.timing) {
    print_timing(*simulation, window, wall);
    if (!window.delay().text().empty()) std::puts(window.delay().text().c_str());
    if (screens) std::puts(screens->status().c_str());
  }
  if (!problem.empty()) throw std::runtime_error(options.scene() + ": " + problem);
  if (!window.film_failure().empty()) throw std::runtime_error(window.film_failure());
}

void run(const ViewOptions& options) {
  if (!options.make_keys.empty()) return write_screen_keys(options.make_keys);
  if (options.tracker == "-")
    return send_head(options, signal_number);  // a signal ends its reading
  const bool is_scene = options.join.empty();
  if (!is_scene) take_signals();
  if (!options.tracker.empty()) return send_head(options, signal_number);
  check_display();
  if (is_scene) return show_scene(options);
  show_screen(options, signal_number);
}

}  // namespace
}  // namespace tetwarp::view

int main(int argument_count, char** arguments) {
  try {
    tetwarp::view::run(tetwarp::view::options_of({arguments + 1, arguments + argument_count}));
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "tetwarp: %s\n", error.what());
    return 1;
  }
}

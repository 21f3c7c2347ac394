/// @file cmd_view.cpp
/// The subcommand view, which starts the program tetwarp-view.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <tetwarp/scene_io.hpp>
#include <vector>

#include "host/cli/common/camera_option.hpp"
#include "host/cli/common/commands.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/file_checks.hpp"
#include "host/view/view_options.hpp"

namespace tetwarp::cli {
namespace {
namespace fs = std::filesystem;

std::vector<fs::path> viewer_places() {
  if (const char* const chosen = std::getenv("TETWARP_VIEWER")) return {chosen};
  std::error_code error;
  const fs::path folder = fs::canonical("/proc/self/exe", error).parent_path();
  return {folder / "tetwarp-view", (folder / TETWARP_VIEWER_FROM_HERE).lexically_normal(),
          TETWARP_VIEWER_INSTALLED};
}

std::string find_viewer() {
  std::string searched;
  for (const fs::path& place : viewer_places()) {
    if (access(place.c_str(), X_OK) == 0) return place;
    searched += (searched.empty() ? "" : ", ") + place.string();
  }
  throw std::runtime_error("view needs the program tetwarp-view, which is not at " + searched +
                           "; it is built where VTK 9 with X11 is found: install libvtk9-dev and "
                           "build again, or set TETWARP_VIEWER to its path");
}

/// Nothing is written to a file that an option names, or twice. The viewer, which reads the scene,
/// checks the files that the scene names.
void check_files(const view::ViewOptions& options) {
  std::vector<std::string> inputs;
  for (const std::string& device : CLI::detail::split(options.devices, ',')) {
    if (fs::exists(device)) inputs.push_back(device);
  }
  for (const std::string& file :
       {options.scene_file, options.replay, options.restart, options.key, options.screens}) {
    if (!file.empty()) inputs.push_back(file);
  }
  check_output_files(options.outputs(), inputs);
}

/// Replaces this process.
int run_view(const view::ViewOptions& options) {
  check_files(options);
  std::vector<std::string> words = view::words_of(options);
  words.insert(words.begin(), find_viewer());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  execv(pointers[0], pointers.data());
  throw std::runtime_error(words[0] + ": cannot be started: " + std::strerror(errno));
}

void set_scene(const std::string& scene, view::ViewOptions& options) {
  const std::vector<std::string> names = scene_names();
  std::error_code error;
  const bool is_name = std::ranges::count(names, scene) > 0 && !fs::exists(scene, error);
  (is_name ? options.scene_name : options.scene_file) = scene;
}

/// Declares an option of finite numbers with commas between them.
template <std::size_t count>
void add_numbers(CLI::App& app,
                 const std::string& option,
                 std::optional<std::array<double, count>>& numbers,
                 const std::string& names,
                 const std::string& description) {
  app.add_option_function<std::array<double, count>>(
         option, [&numbers](const std::array<double, count>& given) { numbers = given; },
         description)
      ->delimiter(',')
      ->check(finite_number())
      ->type_name(names);
}

void declare_picture(CLI::App& app, view::ViewOptions& options, CameraOption& camera) {
  app.add_option_function<std::array<std::int64_t, 2>>(
         "--size",
         [&options](const std::array<std::int64_t, 2>& size) {
           options.width = size[0];
           options.height = size[1];
         },
         "width and height of the window [960,640]")
      ->delimiter(',')
      ->check(between(64, 8192))
      ->type_name("W,H");
  add_camera(app, camera, "that of the scene, or the whole scene at the start");
  app.add_option("--preset", options.preset, "colors of volumes [ct]")
      ->check(CLI::IsMember({"ct", "mr"}).description(""))
      ->type_name("ct|mr");
  app.add_option("--colors", options.colors, "colors of surfaces at the start [none]")
      ->check(CLI::IsMember({"none", "stress", "gap", "adhesion"}).description(""))
      ->type_name("none|stress|gap|adhesion");
  app.add_option("--voxels", options.voxels, "most voxels of all warped volumes, about [2000000]")
      ->check(between(1000, 1'000'000'000))
      ->type_name("N");
  app.add_option("--screenshot", options.screenshot, "picture of the end")->type_name("FILE.png");
  app.add_option("--film", options.film, "film of the window; .png: pictures with numbers")
      ->type_name("FILE.gif|FILE.png");
}

void declare_simulation(CLI::App& app, view::ViewOptions& options) {
  app.add_flag("--paused", options.paused, "wait for a key before the first step");
  app.add_option("--steps", options.steps, "close the window after N steps [no limit]")
      ->check(at_least(0))
      ->type_name("N");
  app.add_flag("--fast", options.fast, "step as fast as possible, not only as fast as time passes");
  app.add_option("--max-step-seconds", options.max_step_seconds,
                 "wall time of a step: solves end in time with what they have [no limit]")
      ->check(above_zero())
      ->type_name("S");
  app.add_flag("--timing", options.timing, "print at the end what steps and pictures took");
  app.add_flag("--untangle", options.untangle,
               "shrink elastic bodies and cloth that intersect others at the start, and let them "
               "grow back within 0.2 s");
  app.add_option("--backend", options.backend, "where to compute [auto]")
      ->check(CLI::IsMember(words_of(choices_of<Backend>())).description(""))
      ->type_name(CLI::detail::join(words_of(choices_of<Backend>()), "|"));
  add_device(app, options.device);
  add_threads(app, options.threads,
              "threads of the cpu back end, 0 for all cores [0]; any number: same results");
}

void declare_input(CLI::App& app, view::ViewOptions& options) {
  app.add_option("--grab-radius", options.grab_radius,
                 "what the mouse holds of an elastic body or cloth [0.08 of its size]")
      ->check(above_zero())
      ->type_name("M");
  app.add_option("--grab-stiffness", options.grab_stiffness,
                 "of the spring to the mouse, N/m [from mass and stiffness of the body]")
      ->check(above_zero())
      ->type_name("K");
  add_numbers(app, "--ball", options.ball, "X,Y,Z,R",
              "center and radius of a ball to push with: the mouse carries it [none]");
  add_numbers(app, "--fingers", options.fingers, "X,Y,Z,IX,IY,IZ,R",
              "centers of an outer finger, which the mouse carries, and of an inner one, and their "
              "radius [none]");
  app.add_option("--skin-stiffness", options.skin_stiffness,
                 "of the spring between the fingers, N/m [500]")
      ->check(above_zero())
      ->type_name("K");
  app.add_option("--devices", options.devices,
                 "gamepad, spacemouse, wand=NAME@HOST by VRPN, or a file of motions, with commas "
                 "between them [none]")
      ->type_name("NAME,...");
  app.add_option("--record", options.record, "write what the mouse did, by step")
      ->type_name("FILE");
  app.add_option("--replay", options.replay, "repeat it: same results")->type_name("FILE");
  app.add_option("--restart", options.restart,
                 "start from the state of a --checkpoint of the same scene")
      ->check(CLI::ExistingFile.description(""))
      ->type_name("FILE");
  app.add_option("--checkpoint", options.checkpoint,
                 "file for the state at the end, for tetwarp simulate --restart")
      ->type_name("FILE");
}

void declare_screens(CLI::App& app, view::ViewOptions& options) {
  app.add_option(
         "--screens", options.screens,
         "draw on the screens of a room as well: JSON, a .pvx file of ParaView, or the name "
         "of a room that ships: wall, cube, amphitheatre")
      ->type_name("ROOM");
  app.add_option("--address", options.address,
                 "where screens find this program [that of the room, tcp://127.0.0.1:5611]")
      ->type_name("tcp://INTERFACE:PORT");
  app.add_option("--join", options.join, "draw a screen of a program on another machine")
      ->type_name("tcp://HOST:PORT");
  app.add_option("--screen", options.screen, "which screen, with --join")->type_name("NAME");
  app.add_option(
         "--tracker", options.tracker,
         "with --join: send poses of the head, of a VRPN tracker, or without a name lines x "
         "y z [qw qx qy qz] from standard input")
      ->expected(0, 1)
      ->default_str("-")
      ->type_name("NAME@HOST");
  app.add_option("--key", options.key, "keys of the room, which other machines need")
      ->check(CLI::ExistingFile.description(""))
      ->type_name("FILE");
  app.add_option("--make-keys", options.make_keys,
                 "write NAME.key for this program and NAME_screen.key for its screens")
      ->type_name("NAME");
}

/// @param mode  the option beside which only those of `used` have an effect
void refuse_others(const CLI::App& command, const std::string& mode, std::set<std::string> used) {
  used.insert(mode);
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() > 0 && !used.contains(option->get_name())) {
      throw CLI::ValidationError(option->get_name(),
                                 "has no effect with " + mode + "; leave it out");
    }
  }
}

/// Keys that are written, and screens and trackers of a master, use few of the options.
void check_mode(const view::ViewOptions& options, const CLI::App& command) {
  if (!options.make_keys.empty()) refuse_others(command, "--make-keys", {});
  if (options.join.empty()) return;
  if (options.screen.empty() == options.tracker.empty()) {
    throw CLI::ValidationError("--join", "needs either --screen NAME or --tracker");
  }
  if (!options.tracker.empty()) {
    refuse_others(command, "--tracker", {"--join", "--key"});
  } else {
    refuse_others(command, "--join",
                  {"--screen", "--key", "--screenshot", "--backend", "--device", "--threads"});
  }
}

void check_view(const view::ViewOptions& options, const CLI::App& command) {
  check_mode(options, command);
  check_device(command, meaning_of("--backend", options.backend, choices_of<Backend>()));
  const bool has_limit = options.max_step_seconds < std::numeric_limits<double>::infinity();
  if (has_limit && !options.replay.empty()) {
    throw CLI::ValidationError(
        "--max-step-seconds",
        "steps of a replay end where those of its record did; leave it out with --replay");
  }
  if (options.ball && !((*options.ball)[3] > 0)) {
    throw CLI::ValidationError("--ball", "the radius, its last number, is above 0");
  }
  if (options.fingers && !((*options.fingers)[6] > 0)) {
    throw CLI::ValidationError("--fingers", "the radius, its last number, is above 0");
  }
  if (!options.fingers && command.get_option("--skin-stiffness")->count() > 0) {
    throw CLI::ValidationError("--skin-stiffness", "needs --fingers");
  }
  if (options.scene().empty() && options.join.empty() && options.make_keys.empty()) {
    throw CLI::ValidationError("SCENE", "is missing: a file, or the name of a scene that ships");
  }
  if (options.join.empty() && (!options.screen.empty() || !options.tracker.empty())) {
    throw CLI::ValidationError("--screen and --tracker", "need --join ADDRESS");
  }
  if (options.screens.empty() && options.join.empty() && !options.key.empty()) {
    throw CLI::ValidationError("--key", "needs --screens or --join");
  }
  if (options.screens.empty() && !options.address.empty()) {
    throw CLI::ValidationError("--address", "needs --screens");
  }
  if (!options.screenshot.empty() && !options.screenshot.ends_with(".png")) {
    throw CLI::ValidationError("--screenshot", "the name of a picture ends in .png");
  }
  if (!options.film.empty() && !options.film.ends_with(".gif") && !options.film.ends_with(".png")) {
    throw CLI::ValidationError("--film", "the name of a film ends in .gif or .png");
  }
}
}  // namespace

void add_view_command(CLI::App& app, Run& run) {
  auto options = std::make_shared<view::ViewOptions>();
  auto camera = std::make_shared<CameraOption>();
  CLI::App* command =
      add_subcommand(app, "view", "Watch a scene move in a window, and pull at it with the mouse",
                     "SCENE|NAME [options]",
                     "  tetwarp view torso\n"
                     "  tetwarp view scene.json --paused --max-step-seconds 0.02\n"
                     "  tetwarp view candy --steps 100 --screenshot candy.png\n"
                     "  tetwarp view torso --screens wall\n"
                     "  tetwarp view --join tcp://master:5611 --screen left --key room_screen.key\n"
                     "Key h shows what mouse and keys do.\n");
  command
      ->add_option_function<std::string>(
          "SCENE", [options](const std::string& scene) { set_scene(scene, *options); },
          "scene file, or the name of a scene that ships with the command")
      ->type_name("");
  declare_picture(*command, *options, *camera);
  declare_simulation(*command, *options);
  declare_input(*command, *options);
  declare_screens(*command, *options);
  command->callback([options, camera, command, &run] {
    options->camera = camera->numbers;
    options->camera_name = camera->name;
    check_view(*options, *command);
    run = [options] { return run_view(*options); };
  });
}

}  // namespace tetwarp::cli

/// @file simulate_arguments.cpp
/// The options of tetwarp simulate, and the checks of their combinations.
#include "host/cli/simulate/simulate_arguments.hpp"

#include "host/cli/common/declare.hpp"
#include "host/cli/job/warp_arguments.hpp"
#include "io/files/extension.hpp"

namespace tetwarp::cli {
namespace {
/// As add_choice(), for a value that may be left open.
template <class T>
void add_optional_choice(CLI::App& app,
                         const std::string& option,
                         std::optional<T>& target,
                         const Choices<T>& choices,
                         const std::string& description) {
  app.add_option_function<std::string>(
         option,
         [&target, option, choices](const std::string& word) {
           target = meaning_of(option, word, choices);
         },
         description)
      ->type_name(CLI::detail::join(words_of(choices), "|"));
}

void declare_scene(CLI::App& app, SimulateArguments& arguments) {
  app.add_option("SCENE", arguments.scene_file, "scene file, JSON")->type_name("");
  app.add_option("--scene", arguments.scene_name,
                 "a scene that ships with the command instead of a file; `list` shows their names")
      ->type_name("NAME|list");
  app.add_flag("--print", arguments.print, "print the scene's JSON and do nothing else");
  app.add_option("-o,--output", arguments.folder, "folder for the results, made if missing")
      ->type_name("FOLDER");
  app.add_option("--steps", arguments.steps, "steps from the start of the scene [its duration]")
      ->check(at_least(0))
      ->type_name("N");
  app.add_flag(
      "--untangle", arguments.simulate.untangle,
      "shrink elastic bodies and cloth that intersect others at the start, and let them grow "
      "back within 0.2 s");
  app.add_option("--checkpoint", arguments.checkpoint,
                 "file for the state at the end, also of an interrupted run, to go on later")
      ->type_name("FILE");
  app.add_option("--checkpoint-every", arguments.checkpoint_every,
                 "write the checkpoint every N steps, too")
      ->check(at_least(1))
      ->type_name("N");
  app.add_option("--restart", arguments.restart,
                 "go on from a checkpoint; results in the folder up to it are kept")
      ->type_name("FILE");
}

void declare_contact(CLI::App& app, SimulateArguments& arguments) {
  app.add_option("--contacts", arguments.contacts,
                 "write the contacts of every output as points with normals and impulses")
      ->type_name("FILE.vtkhdf");
  add_optional_choice(app, "--law", arguments.law, choices_of<FrictionLaw>(),
                      "friction law [that of the scene]");
  add_optional_choice(app, "--rule", arguments.rule, choices_of<AdhesionRule>(),
                      "friction beside adhesion [that of the scene]");
  app.add_flag(
      "--no-adhesion", [&arguments](std::int64_t) { arguments.adheres = false; },
      "let nothing adhere, whatever the scene says");
}

void declare_warping(CLI::App& app, SimulateArguments& arguments) {
  app.add_option_function<std::string>(
         "--warp",
         [&arguments](const std::string& name) {
           arguments.warps = true;
           arguments.warped_body = name;
         },
         "warp the volumes of bodies, or of the body NAME, at every output: "
         "NAME.warped_0000.vtkhdf ...")
      ->expected(0, 1)
      ->type_name("[NAME]");
  declare_grid_options(app, arguments.grid);
  declare_sampling_options(app, arguments.warp);
  declare_outside_options(app, arguments.warp);
  declare_extra_outputs(app, arguments.extra);
  app.add_option("--compress", arguments.compress,
                 "deflate level of warped volumes, 0 for none [0]")
      ->check(between(0, 9))
      ->type_name("L");
}

void declare_pictures(CLI::App& app, SimulateArguments& arguments) {
  app.add_flag("--picture", arguments.draws, "draw every output: scene_0000.png ...");
  app.add_option("--film", arguments.film, "write these pictures as an animated GIF")
      ->type_name("FILE.gif");
  add_camera(app, arguments.pictures.camera, "that of the scene, or the whole scene at the start");
  declare_picture_options(app, arguments.pictures,
                          "draw the volumes of bodies by rays in place of their surfaces");
}

void declare_running(CLI::App& app, SimulateArguments& arguments) {
  SimulateOptions& simulate = arguments.simulate;
  add_choice(app, "--backend", simulate.backend, choices_of<Backend>(), "where to compute [auto]");
  add_device(app, simulate.device);
  add_threads(app, simulate.threads,
              "threads of the cpu back end, 0 for all cores [0]; any number: same results");
  app.add_option("--max-iterations", simulate.max_iterations,
                 "of conjugate gradients per solve [10000]")
      ->check(at_least(1))
      ->type_name("N");
  app.add_option("--max-step-seconds", simulate.max_step_seconds,
                 "wall time of a step: solves end in time with what they have [no limit]")
      ->check(CLI::PositiveNumber)
      ->type_name("S");
  app.add_option("--report", arguments.report, "report as JSON [FOLDER/report.json]")
      ->type_name("FILE");
  add_quiet(app, arguments.quiet);
}

[[noreturn]] void refuse(const std::string& option, const std::string& problem) {
  throw CLI::ValidationError(option, problem);
}

void check_file_options(const SimulateArguments& arguments) {
  if (arguments.folder.empty()) refuse("-o FOLDER", "a folder for the results is needed");
  if (arguments.checkpoint_every > 0 && arguments.checkpoint.empty()) {
    refuse("--checkpoint-every", "needs --checkpoint FILE");
  }
  if (!arguments.film.empty() && !has_extension(arguments.film, ".gif")) {
    refuse("--film", "the name of a film ends in .gif");
  }
  if (!arguments.contacts.empty() && !has_extension(arguments.contacts, ".vtkhdf")) {
    refuse("--contacts", "the name of a file of contacts ends in .vtkhdf");
  }
}

void check_pictures(const SimulateArguments& arguments) {
  const bool draws = arguments.draws || !arguments.film.empty();
  if (arguments.pictures.camera.is_given() && !draws)
    refuse("--camera", "needs --picture or --film");
  if (arguments.pictures.pixels && !draws) refuse("--pixels", "needs --picture or --film");
  if (!arguments.pictures.cast.empty() && !draws) refuse("--cast", "needs --picture or --film");
}
}  // namespace

void declare_simulate_options(CLI::App& app, SimulateArguments& arguments) {
  declare_scene(app, arguments);
  declare_contact(app, arguments);
  declare_running(app, arguments);
  declare_pictures(app, arguments);
  declare_warping(app, arguments);
}

void check_warping(const CLI::App& app, const SimulateArguments& arguments) {
  if (arguments.warps) return;
  const auto is_given = [&](const char* option) { return app.get_option(option)->count() > 0; };
  for (const char* option : {"--compress", "--outputs"}) {
    if (is_given(option)) refuse(option, "needs --warp");
  }
  if (!arguments.pictures.cast.empty()) return;
  for (const char* option : {"--grid", "--like", "--like-series", "--dims", "--origin", "--spacing",
                             "--direction", "--filter", "--label-rule", "--overshoot",
                             "--antialias", "--intensity", "--outside", "--background"}) {
    if (is_given(option)) refuse(option, "needs --warp or --cast");
  }
}

void check_complete(const SimulateArguments& arguments) {
  if (arguments.scene_name == "list") return;
  if (arguments.scene_file.empty() == arguments.scene_name.empty()) {
    refuse("SCENE", "expected a scene file or --scene NAME, one of them");
  }
  if (arguments.print) return;
  check_file_options(arguments);
  check_pictures(arguments);
  check_sampling(arguments.warp);
}

}  // namespace tetwarp::cli

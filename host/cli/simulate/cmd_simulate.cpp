/// @file cmd_simulate.cpp
/// The subcommand simulate.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <tetwarp/error.hpp>
#include <tetwarp/scene_io.hpp>
#include <vector>

#include "host/cli/common/commands.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/interrupt.hpp"
#include "host/cli/simulate/simulate_run.hpp"
#include "io/files/text_file.hpp"

namespace tetwarp::cli {
namespace {
constexpr int not_converged_exit_code = 3;

int list_scenes() {
  for (const std::string& name : scene_names()) fmt::print("{}\n", name);
  return 0;
}

int print_scene(const SimulateArguments& arguments) {
  if (!arguments.scene_name.empty()) {
    fmt::print("{}", scene_text(arguments.scene_name));
    return 0;
  }
  read_scene(arguments.scene_file);  // its errors
  fmt::print("{}", read_text(arguments.scene_file));
  return 0;
}

void print_summary(const SimulateArguments& arguments,
                   const SimulateRun& run,
                   const SimulateResult& result) {
  const std::int64_t steps = result.steps_done - result.first_step;
  fmt::print("{} step{}, {} frame{}, {:.4g} s of time in {:.2f} s on {}: {}\n", steps,
             steps == 1 ? "" : "s", result.frames, result.frames == 1 ? "" : "s",
             run.simulator().time(), result.total_seconds, name_of(run.simulator().backend()),
             arguments.folder);
}

/// Throws IoError where a scene that ships with the command is given as a file.
void check_scene_file(const std::string& file) {
  const std::vector<std::string> names = scene_names();
  if (std::filesystem::is_regular_file(file) ||
      std::find(names.begin(), names.end(), file) == names.end()) {
    return;
  }
  throw IoError(file, "",
                "is no file; for the scene that ships with the command give --scene " + file);
}

int run_simulate(const SimulateArguments& arguments) {
  if (arguments.scene_name == "list") return list_scenes();
  check_scene_file(arguments.scene_file);
  if (arguments.print) return print_scene(arguments);
  const InterruptFlag interrupts_set_a_flag;
  SimulateRun run(arguments);
  const SimulateResult& result = run.run();
  if (!arguments.quiet) {
    print_warnings(result.warnings, "");
    if (!result.is_interrupted) print_summary(arguments, run, result);
  }
  if (result.is_interrupted) throw Cancelled();
  return result.unconverged_steps + result.late_steps > 0 ? not_converged_exit_code : 0;
}
}  // namespace

void add_simulate_command(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<SimulateArguments>();
  CLI::App* command = add_subcommand(
      app, "simulate", "Step a scene of rigid, elastic and cloth bodies through time",
      "SCENE -o FOLDER [options]",
      "  tetwarp simulate scene.json -o results --film film.gif\n"
      "  tetwarp simulate head.json -o results --warp --steps 100\n"
      "  tetwarp simulate scene.json -o results --checkpoint state.bin --checkpoint-every 100\n"
      "  tetwarp simulate scene.json -o results --restart state.bin\n"
      "  tetwarp simulate --scene list\n"
      "Exit status: 0 done; 3 done, but a step stayed above its tolerance; 130 interrupted, the "
      "results so far are complete; 2 bad usage; 1 any other failure\n");
  declare_simulate_options(*command, *arguments);
  command->callback([arguments, command, &run] {
    arguments->has_filter = command->get_option("--filter")->count() > 0;
    check_complete(*arguments);
    check_warping(*command, *arguments);
    check_device(*command, arguments->simulate.backend);
    run = [arguments] { return run_simulate(*arguments); };
  });
}

}  // namespace tetwarp::cli

/// @file main.cpp
/// The command `tetwarp`: subcommands, exit codes, one-line errors.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <tetwarp/error.hpp>
#include <tetwarp/version.hpp>
#include <vector>

#include "host/cli/common/commands.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/interrupt.hpp"
#include "host/cli/common/ranks.hpp"

namespace tetwarp::cli {
namespace {
constexpr int failed_exit_code = 1;
constexpr int usage_exit_code = 2;

/// Prints an error in one line. A usage error is found by all ranks before MPI_Init: rank 0 prints
/// it and fails; the others return 0, since mpirun kills all ranks as soon as one has failed.
/// @returns the exit code of this process
int print_error(const std::string& problem, int exit_code, bool is_found_by_all = false) {
  if (is_found_by_all && launched_rank() > 0) return 0;
  delay_by_rank();
  fmt::print(stderr, "tetwarp: {}\n", one_line(problem));
  return exit_code;
}

void declare(CLI::App& app, Run& run) {
  app.set_version_flag("--version", "tetwarp " TETWARP_VERSION);
  app.require_subcommand(1);
  add_warp_command(app, run);
  add_simulate_command(app, run);
  add_view_command(app, run);
  add_contact_command(app, run);
  add_certify_command(app, run);
  add_mesh_command(app, run);
  add_deform_command(app, run);
  add_points_command(app, run);
  add_compose_command(app, run);
  add_invert_command(app, run);
  add_import_command(app, run);
  add_export_command(app, run);
  add_render_command(app, run);
  add_plot_command(app, run);
  add_info_command(app, run);
  add_demo_command(app, run);
  app.footer("tetwarp SUBCOMMAND --help shows options and an example.\nTo begin: tetwarp demo");
}

/// Throws CLI::ValidationError on an unknown subcommand; CLI11 would report a missing one.
void check_subcommand(const CLI::App& app, int argument_count, const char* const* arguments) {
  if (argument_count < 2 || arguments[1][0] == '-') return;
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  if (std::find(names.begin(), names.end(), arguments[1]) == names.end()) {
    const std::string remedy = did_you_mean(arguments[1], names);
    throw CLI::ValidationError(
        std::string("'") + arguments[1] + "'",
        "no such subcommand; there are " + listed(names) + (remedy.empty() ? "" : "; " + remedy));
  }
}

/// Prints help or version, which CLI11 throws as errors too; for all other errors one line that
/// refers to the help. @returns the exit code
int handle_parse_error(const CLI::App& app, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) return app.exit(error);
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  const std::string command = chosen.empty() ? "tetwarp" : "tetwarp " + chosen[0]->get_name();
  return print_error(fmt::format("{} (see {} --help)", error.what(), command), usage_exit_code,
                     true);
}

int run_main(int argument_count, const char* const* arguments) {
  CLI::App app(
      "Warps dense volumes by deforming tetrahedral meshes and solves adhesive frictional contact",
      "tetwarp");
  Run run;
  declare(app, run);
  try {
    check_subcommand(app, argument_count, arguments);
    app.parse(argument_count, arguments);
  } catch (const CLI::ParseError& error) {
    return handle_parse_error(app, error);
  }
  const int exit_code = run();
  if (std::fflush(stdout) != 0) throw std::runtime_error("standard output: cannot be written");
  return exit_code;
}

int guarded_main(int argument_count, const char* const* arguments) {
  try {
    return run_main(argument_count, arguments);
  } catch (const Cancelled&) {
    return interrupted_exit_code;  // the handler of the signal has printed a line
  } catch (const std::bad_alloc&) {
    return print_error("out of memory; use a smaller problem or, for volumes, --roi or --dims",
                       failed_exit_code);
  } catch (const std::exception& error) {
    return print_error(error.what(), failed_exit_code);
  }
}
}  // namespace
}  // namespace tetwarp::cli

int main(int argument_count, char** arguments) {
  tetwarp::cli::install_interrupt_handlers();
  const int exit_code = tetwarp::cli::guarded_main(argument_count, arguments);
  if (exit_code == 0) return 0;
  tetwarp::cli::abort_ranks(exit_code);
  // Skips exit handlers: that of HDF5 1.10 crashes when a file could not be closed on a full disk.
  // All files are closed or removed by now.
  std::fflush(nullptr);
  std::_Exit(exit_code);
}

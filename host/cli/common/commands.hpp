/// @file commands.hpp
/// The subcommands. Each function declares one on `app`; parsing a command line that chooses it
/// stores in `run` the function to call.
#pragma once
#include <CLI/CLI.hpp>
#include <functional>

namespace tetwarp::cli {

/// The chosen subcommand with its arguments bound. Returns the exit code; failures are exceptions.
using Run = std::function<int()>;

void add_warp_command(CLI::App& app, Run& run);
void add_mesh_command(CLI::App& app, Run& run);
void add_deform_command(CLI::App& app, Run& run);
void add_points_command(CLI::App& app, Run& run);
void add_compose_command(CLI::App& app, Run& run);
void add_invert_command(CLI::App& app, Run& run);
void add_contact_command(CLI::App& app, Run& run);
void add_certify_command(CLI::App& app, Run& run);
void add_simulate_command(CLI::App& app, Run& run);
void add_view_command(CLI::App& app, Run& run);
void add_import_command(CLI::App& app, Run& run);
void add_export_command(CLI::App& app, Run& run);
void add_render_command(CLI::App& app, Run& run);
void add_plot_command(CLI::App& app, Run& run);
void add_info_command(CLI::App& app, Run& run);
void add_demo_command(CLI::App& app, Run& run);

}  // namespace tetwarp::cli

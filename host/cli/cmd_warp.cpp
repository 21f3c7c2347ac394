/// @file cmd_warp.cpp
#include <fmt/format.h>

#include <memory>

#include "host/cli/batch.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/declare.hpp"
#include "host/cli/warp_job.hpp"

namespace tetwarp::cli {

namespace {

int run_warp(const WarpArguments& arguments) {
  const JobResult result = run_warp_job(arguments, {.shows_progress = !arguments.quiet});
  if (!arguments.quiet) fmt::print("{}", summary(result));
  return 0;
}

}  // namespace

void add_warp_command(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<WarpArguments>();
  CLI::App* command = add_subcommand(
      app, "warp", "Warp volumes by a deforming mesh", "VOLUME... MESH -o OUT [options]",
      "  tetwarp warp ct.vtkhdf mesh.vtkhdf -o warped.vtkhdf\n"
      "  tetwarp warp ct.vtkhdf mesh.vtkhdf -o warped.vtkhdf "
      "--steps 0:10:2 --outputs mask --resume\n"
      "  tetwarp warp atlas.vtkhdf mesh.vtkhdf -o atlas_warped.vtkhdf "
      "--filter labels\n"
      "  tetwarp warp --batch jobs.json --compress 1\n");
  declare_warp_options(*command, *arguments);
  command->callback([arguments, command, &run] {
    check_complete(*arguments);
    run = [arguments, command] {
      return arguments->batch.empty() ? run_warp(*arguments) : run_batch(*arguments, *command);
    };
  });
}

}  // namespace tetwarp::cli

/// @file cmd_warp.cpp
/// The subcommand warp.
#include <fmt/format.h>

#include <memory>
#include <stdexcept>
#include <tetwarp/backend.hpp>

#include "host/cli/common/commands.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/ranks.hpp"
#include "host/cli/warp/batch.hpp"
#include "host/cli/warp/transform_job.hpp"
#include "host/cli/warp/warp_job.hpp"

namespace tetwarp::cli {
namespace {
/// Number of usable CUDA devices.
int device_count() {
  int count = 0;
  while (available_backends(count).front().usable) ++count;
  return count;
}

int run_warp(WarpArguments arguments) {
  if (names_transform(arguments)) {
    const JobResult result = run_transform_job(arguments, {.shows_progress = !arguments.quiet});
    if (!arguments.quiet) fmt::print("{}", transform_summary(arguments, result));
    if (!result.refusal.empty()) throw std::runtime_error(result.refusal);
    return 0;
  }
  Ranks ranks = Ranks::start();
  const int devices = ranks.count() > 1 ? device_count() : 0;
  if (devices > 1) arguments.warp.device = launched_local_rank() % devices;
  const JobResult result =
      run_warp_job(arguments, {.shows_progress = !arguments.quiet, .ranks = &ranks});
  if (!arguments.quiet && ranks.is_root()) fmt::print("{}", summary(result));
  if (!result.refusal.empty()) throw std::runtime_error(result.refusal);
  ranks.finish();
  return 0;
}
}  // namespace

void add_warp_command(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<WarpArguments>();
  CLI::App* command = add_subcommand(
      app, "warp",
      "Warp volumes by a deforming mesh, or by a displacement field or affine transform",
      "VOLUME... MESH|TRANSFORM -o OUT [options]",
      "  tetwarp warp ct.nii.gz mesh.vtu -o warped.nii.gz\n"
      "  tetwarp warp ct.vtkhdf mesh.vtkhdf -o warped.vtkhdf "
      "--steps 0:10:2 --outputs mask --resume\n"
      "  tetwarp warp atlas.nii.gz mesh.vtkhdf -o atlas_warped.nii.gz "
      "--filter labels\n"
      "  tetwarp warp ct.nii.gz 1Warp.nii.gz -o warped.nii.gz --like fixed.nii.gz\n"
      "  tetwarp warp --batch jobs.csv --jobs 4 --resume\n"
      "  tetwarp warp large.vtkhdf mesh.vtkhdf -o warped.vtkhdf --memory 4G\n"
      "  mpirun -n 4 tetwarp warp ct.vtkhdf mesh.vtkhdf -o warped.vtkhdf\n");
  declare_warp_options(*command, *arguments);
  command->callback([arguments, command, &run] {
    arguments->given = given_options(*command);
    check_complete(*arguments);
    check_device(*command, arguments->warp.backend);
    if (!arguments->batch.empty() && launched_count() > 1) {
      throw CLI::ValidationError("--batch", "runs without mpirun; start one mpirun for each job");
    }
    if (arguments->resume && arguments->provenance && launched_count() > 1) {
      throw CLI::ValidationError("--resume",
                                 "with --provenance runs without mpirun; leave out one of the two");
    }
    if (arguments->batch.empty() && launched_count() > 1 && names_transform(*arguments)) {
      throw CLI::ValidationError("TRANSFORM",
                                 "runs without mpirun; --threads divides a warp by a transform");
    }
    if (arguments->batch.empty() && arguments->warp.count_folded && arguments->report.empty() &&
        !names_transform(*arguments)) {
      throw CLI::ValidationError("--count-folded", count_folded_refusal);
    }
    run = [arguments, command] {
      return arguments->batch.empty() ? run_warp(*arguments) : run_batch(*arguments, *command);
    };
  });
}

}  // namespace tetwarp::cli

/// @file series_in_parts.cpp
/// Writes the steps of a series to files of their own and joins these.
#include "host/cli/warp/volumes/series_in_parts.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "host/base/stopwatch.hpp"
#include "host/cli/common/interrupt.hpp"
#include "host/cli/warp/volumes/step_writer.hpp"
#include "host/cli/warp/volumes/volume_run.hpp"

namespace tetwarp::cli {
namespace {
namespace fs = std::filesystem;

/// The files of the steps, in a folder beside the output.
std::vector<std::string> part_names(const fs::path& folder, const std::vector<WarpStep>& steps) {
  std::vector<std::string> names;
  names.reserve(steps.size());
  for (const WarpStep& step : steps) {
    names.push_back((folder / fmt::format("step_{:04}.vtkhdf", step.number)).string());
  }
  return names;
}

/// Joins the files of the steps.
/// @param files  one per step of the job
/// @returns what was written
Counts join(const VolumeTask& task,
            const Fingerprint& fingerprint,
            const std::vector<std::string>& files) {
  const WarpArguments& arguments = task.arguments;
  const std::vector<WarpStep>& steps = task.volume.steps;
  StepWriter writer(task);
  writer.begin_series(task.volume.outputs.front(), fingerprint);
  std::vector<Point3> last;
  for (std::size_t s = 0; s < steps.size(); ++s) {
    stop_if_interrupted();
    std::vector<Point3> positions = task.job.mesh.read_step(steps[s].mesh_step);
    const bool is_same_source = s > 0 && steps[s].volume_step == steps[s - 1].volume_step;
    if (arguments.warp.expert.skip.unchanged_steps && is_same_source && positions == last) {
      writer.repeat_step(steps[s].time);
    } else {
      writer.copy_step(steps[s].time, files[s]);
    }
    last = std::move(positions);
  }
  stop_if_interrupted();
  return writer.finish();
}
}  // namespace

void write_series_in_parts(const VolumeTask& task,
                           const Fingerprint& fingerprint,
                           Ranks& ranks,
                           ProgressBar& bar,
                           JobResult& result) {
  const fs::path folder = task.volume.outputs.front() + ".steps";
  VolumePlan parts = task.volume;
  parts.is_series = false;
  parts.outputs = parts.files = part_names(folder, parts.steps);
  WarpArguments arguments = task.arguments;
  arguments.compress = 0;
  fs::create_directories(folder);
  const std::int64_t written = result.written, skipped = result.skipped;
  VolumeRun(arguments, task.job, parts, ranks, bar, result).run();
  result.written = written + task.volume.files_per_output();
  result.skipped = skipped;
  bar.show_phase("writing");
  const Stopwatch watch;
  result.report.counts += join(task, fingerprint, parts.outputs);
  result.report.timings.write += watch.seconds();
  std::error_code ignored;
  for (const std::string& part : parts.outputs) fs::remove(part, ignored);
  fs::remove(folder, ignored);
}

}  // namespace tetwarp::cli

/// @file warp_job.cpp
#include "host/cli/warp_job.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <tetwarp/version.hpp>

#include "host/cli/interrupt.hpp"
#include "host/cli/job_plan.hpp"
#include "host/cli/progress_bar.hpp"
#include "host/cli/stopwatch.hpp"
#include "host/cli/volume_run.hpp"
#include "io/finished_file.hpp"

namespace tetwarp::cli {

JobResult run_warp_job(const WarpArguments& arguments, const JobContext& context) {
  const PoliteInterrupts polite;
  const Stopwatch watch;
  const JobPlan plan = plan_job(arguments);
  JobResult result;
  result.outputs = plan.outputs();
  result.report.version = TETWARP_VERSION;
  result.report.backend = plan.backend;
  result.report.backend_reason = plan.backend_reason;
  if (!plan.output_folder.empty()) std::filesystem::create_directory(plan.output_folder);
  {
    ProgressBar bar(context.shows_progress, context.label,
                    static_cast<double>(plan.volumes.size() * plan.steps.size()));
    for (const VolumePlan& volume : plan.volumes) {
      VolumeRun(arguments, plan, volume, bar, result).run();
    }
  }
  result.report.timings.total = watch.seconds();
  if (!arguments.report.empty()) write_finished_file(arguments.report, report_json(result) + "\n");
  return result;
}

std::string report_json(const JobResult& result) {
  auto json = nlohmann::ordered_json::parse(to_json(result.report));
  json["status"] = result.written == 0 ? "skipped" : "done";
  json["outputs"] = result.outputs;
  json["outputs_skipped"] = result.skipped;
  return json.dump(2);
}

std::string summary(const JobResult& result) {
  const Report& report = result.report;
  const Counts& counts = report.counts;
  std::string text = fmt::format("{}: {}\n", name_of(report.backend), report.backend_reason);
  text += fmt::format("{} written", result.written);
  if (result.skipped > 0) text += fmt::format(", {} skipped", result.skipped);
  if (counts.voxels > 0) {
    text += fmt::format(", {} of {} voxels covered", counts.covered, counts.voxels);
  }
  text += fmt::format(", {:.2f} s: {}", report.timings.total, result.outputs.front());
  if (result.outputs.size() > 1) text += " to " + result.outputs.back();
  return text + "\n";
}

}  // namespace tetwarp::cli

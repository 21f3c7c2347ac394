#include "host/cli/warp_job.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <tetwarp/version.hpp>

#include "host/cli/interrupt.hpp"
#include "host/cli/job_plan.hpp"
#include "host/cli/job_share.hpp"
#include "host/cli/progress_bar.hpp"
#include "host/cli/stopwatch.hpp"
#include "io/finished_file.hpp"
#include "io/memory.hpp"

namespace tetwarp::cli {
namespace {
/// Steps that the progress bar of the root counts: only its own if outputs are divided among ranks.
std::size_t progress_steps(const JobPlan& plan, const Ranks& ranks) {
  const std::size_t outputs = plan.outputs().size();
  const auto count = static_cast<std::size_t>(ranks.count());
  if (outputs == 1) return plan.steps.size();
  return (plan.volumes.size() * plan.steps.size() + count - 1) / count;
}

std::string plan_text(const StepPlan& plan) {
  std::string text =
      fmt::format("{} step {}: {} x {} x {} voxels, {} of memory", plan.volume, plan.step,
                  plan.dims[0], plan.dims[1], plan.dims[2], bytes_text(plan.memory));
  if (plan.blocks == 0) return text + "\n";
  return text + fmt::format(", {} blocks of up to {} voxels from windows of up to {}, {} to read\n",
                            plan.blocks, plan.largest_block, plan.largest_window,
                            bytes_text(plan.bytes_read));
}
}  // namespace

JobResult run_warp_job(const WarpArguments& arguments, const JobContext& context) {
  const InterruptFlag interrupts_set_a_flag;
  const Stopwatch watch;
  Ranks alone;
  Ranks& ranks = context.ranks == nullptr ? alone : *context.ranks;
  // The root plans first: an error in the plan ends all ranks before the others print it, too.
  if (!ranks.is_root()) ranks.wait_for_all();
  const JobPlan plan = plan_job(arguments);
  JobResult result;
  result.outputs = plan.outputs();
  result.report.version = TETWARP_VERSION;
  result.report.backend = plan.backend;
  result.report.backend_reason = plan.backend_reason;
  if (ranks.is_root()) {
    if (!plan.output_folder.empty() && !arguments.dry_run) {
      std::filesystem::create_directory(plan.output_folder);
    }
    ranks.wait_for_all();
  }
  {
    ProgressBar bar(context.shows_progress && ranks.is_root(), context.label,
                    static_cast<double>(progress_steps(plan, ranks)));
    std::size_t task = 0;
    for (const VolumePlan& volume : plan.volumes) {
      if (!arguments.dry_run) {
        run_volume(arguments, plan, volume, ranks, task, bar, result);
      } else if (ranks.is_root()) {
        plan_only(arguments, plan, volume, bar, result);
        if (result.refusal.empty()) result.refusal = volume.refusal;
      }
      task += volume.outputs.size();
    }
  }
  gather_results(ranks, result);
  result.report.timings.total = watch.seconds();
  if (!arguments.report.empty() && ranks.is_root()) {
    write_finished_file(arguments.report, report_json(result) + "\n");
  }
  return result;
}

std::string report_json(const JobResult& result) {
  auto json = nlohmann::ordered_json::parse(to_json(result.report));
  json["status"] = !result.plans.empty() ? "planned" : result.written == 0 ? "skipped" : "done";
  json["outputs"] = result.outputs;
  json["outputs_skipped"] = result.skipped;
  for (const StepPlan& plan : result.plans) {
    json["plans"].push_back({{"volume", plan.volume},
                             {"step", plan.step},
                             {"dims", plan.dims},
                             {"memory", plan.memory},
                             {"blocks", plan.blocks},
                             {"largest_block", plan.largest_block},
                             {"largest_window", plan.largest_window},
                             {"bytes_read", plan.bytes_read}});
  }
  return json.dump(2);
}

std::string summary(const JobResult& result) {
  const Report& report = result.report;
  const Counts& counts = report.counts;
  std::string text = fmt::format("{}: {}\n", name_of(report.backend), report.backend_reason);
  for (const StepPlan& plan : result.plans) text += plan_text(plan);
  if (!result.plans.empty()) return text;
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

/// @file warp_job.cpp
/// Runs a job from its plan to its report.
#include "host/cli/warp/warp_job.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <tetwarp/error.hpp>
#include <tetwarp/version.hpp>

#include "host/base/stopwatch.hpp"
#include "host/cli/common/declare.hpp"
#include "host/cli/common/interrupt.hpp"
#include "host/cli/common/json_text.hpp"
#include "host/cli/common/progress_bar.hpp"
#include "host/cli/job/job_plan.hpp"
#include "host/cli/job/provenance.hpp"
#include "host/cli/warp/job_share.hpp"
#include "io/files/finished_file.hpp"
#include "io/files/memory.hpp"

namespace tetwarp::cli {
namespace {
/// Work of the steps that the progress bar of the root counts [voxels of all arrays]: only its own
/// steps, taken as equal, if outputs are divided among ranks.
std::vector<double> progress_work(const WarpArguments& arguments,
                                  const JobPlan& plan,
                                  const Ranks& ranks) {
  std::vector<double> work;
  for (const VolumePlan& volume : plan.volumes) {
    const auto arrays = static_cast<double>(volume.arrays.size() + arguments.extra.size());
    const auto voxels = static_cast<double>(volume.written_grid.voxel_count());
    work.insert(work.end(), volume.steps.size(), voxels * arrays);
  }
  const auto count = static_cast<std::size_t>(ranks.count());
  std::size_t outputs = 0;
  for (const VolumePlan& volume : plan.volumes) outputs += volume.outputs.size();
  if (count > 1 && outputs > 1) work.assign((work.size() + count - 1) / count, 1);
  return work;
}

std::string plan_text(const StepPlan& plan) {
  std::string text =
      fmt::format("{} step {}: {} x {} x {} voxels, {} of memory", plan.volume, plan.step,
                  plan.dims[0], plan.dims[1], plan.dims[2], bytes_text(plan.memory));
  if (plan.disk > 0) text += fmt::format(", {} of disk for a while", bytes_text(plan.disk));
  if (plan.blocks == 0) return text + "\n";
  return text + fmt::format(", {} blocks of up to {} voxels from windows of up to {}, {} to read\n",
                            plan.blocks, plan.largest_block, plan.largest_window,
                            bytes_text(plan.bytes_read));
}

/// What --pair, --temporal and a mesh of one step made of the steps, once for equal volumes; empty:
/// one file for each step of the mesh.
std::string steps_text(const WarpArguments& arguments, const JobPlan& plan) {
  std::set<std::string> texts;
  for (const VolumePlan& volume : plan.volumes) {
    const std::size_t count = volume.steps.size();
    std::string text = volume.has_one_deformation
                           ? fmt::format("{} steps of the volume by the one of the mesh", count)
                       : arguments.pair
                           ? fmt::format("{} pair{} of steps", count, count == 1 ? "" : "s")
                       : volume.is_series ? fmt::format("{} steps of the mesh", count)
                                          : "";
    if (!text.empty() && volume.is_series) text += " in one file";
    if (!text.empty()) texts.insert(text);
  }
  return fmt::format("{}", fmt::join(texts, "; "));
}

/// Whether all outputs stay as they are, by the files of --provenance beside them. Where one of
/// these contradicts, --resume is turned off: the job is computed again.
bool keeps_outputs(const JobPlan& plan,
                   const InputFacts& inputs,
                   WarpArguments& arguments,
                   JobResult& result) {
  if (!arguments.resume || !arguments.provenance || arguments.dry_run) return false;
  const ProvenanceState state = provenance_state(arguments, inputs, plan.outputs());
  arguments.resume = state != ProvenanceState::contradicts;
  if (state != ProvenanceState::agrees) return false;
  for (const VolumePlan& volume : plan.volumes) result.skipped += std::ssize(volume.outputs);
  return true;
}

/// Names the mesh in errors about its positions, which a Warper finds.
template <class Function>
void with_mesh_named(const std::string& mesh, const Function& function) {
  try {
    function();
  } catch (const std::invalid_argument& error) {
    const std::string problem = error.what();
    if (!problem.starts_with("mesh: ") && !problem.starts_with("deformed positions: ")) throw;
    throw IoError(mesh, "", problem + "; correct the positions, or check units and axes");
  }
}

/// What is known before anything is computed.
JobResult planned_result(const WarpArguments& arguments, const JobPlan& plan) {
  JobResult result;
  result.outputs = plan.outputs();
  result.steps = steps_text(arguments, plan);
  result.report.version = TETWARP_VERSION;
  result.report.backend = plan.backend;
  result.report.backend_reason = plan.backend_reason;
  return result;
}

/// By how much rounding and clipping changed the total of a warp with Intensity::conservative to
/// integers, for the step and component where that is most. Empty if no total has changed.
Warnings storing_notes(const Report& report) {
  const StepReport* most = nullptr;
  std::size_t component = 0;
  double largest = 0;
  std::size_t totals = 0;
  for (const StepReport& step : report.steps) {
    for (std::size_t c = 0; c < step.totals.rounding.size(); ++c) {
      ++totals;
      const double change = std::abs(step.totals.relative_change(c));
      if (most != nullptr && !(change > largest)) continue;
      most = &step;
      component = c;
      largest = change;
    }
  }
  if (most == nullptr) return {};
  const Totals& total = most->totals;
  const double rounding = total.rounding[component], clipping = total.clipping[component];
  if (rounding == 0 && clipping == 0) return {};
  const std::string where =
      totals == 1 ? "" : fmt::format(" (step {}, component {})", most->step, component);
  std::string text = fmt::format(
      "conservative{}: rounding to integers changed the total by {:+.3g}, clipping by "
      "{:+.3g}, together {:+.2g} of it",
      where, rounding, clipping, total.relative_change(component));
  if (report.counts.values_clipped > 0) {
    text += fmt::format("; {} values beyond the limits of the pixel type, use float32 to keep them",
                        report.counts.values_clipped);
  }
  return {text};
}

/// Computes all volumes, or plans them with --dry-run.
void run_volumes(const WarpArguments& arguments,
                 const JobPlan& plan,
                 const JobContext& context,
                 Ranks& ranks,
                 JobResult& result) {
  ProgressBar bar(context.shows_progress && ranks.is_root(), context.label,
                  progress_work(arguments, plan, ranks));
  std::size_t task = 0;
  for (const VolumePlan& volume : plan.volumes) {
    with_mesh_named(arguments.mesh_file(), [&] {
      if (!arguments.dry_run) {
        run_volume(arguments, plan, volume, ranks, task, bar, result);
      } else if (ranks.is_root()) {
        plan_only(arguments, plan, volume, bar, result);
        if (result.refusal.empty()) result.refusal = volume.refusal;
      }
    });
    task += volume.outputs.size();
  }
}

void write_job_report(const WarpArguments& arguments, const JobResult& result) {
  if (arguments.report.empty()) return;
  write_finished_file(arguments.report, report_json(result) + "\n");
}
}  // namespace

JobResult run_warp_job(const WarpArguments& given, const JobContext& context) {
  const InterruptFlag interrupts_set_a_flag;
  const Stopwatch watch;
  Ranks alone;
  Ranks& ranks = context.ranks == nullptr ? alone : *context.ranks;
  // The root plans first: an error in the plan ends all ranks before the others print it, too.
  if (!ranks.is_root()) ranks.wait_for_all();
  const JobPlan plan = plan_job(given);
  WarpArguments arguments = given;
  if (arguments.strict) refuse_warnings(plan.warnings);
  JobResult result = planned_result(arguments, plan);
  if (ranks.is_root()) {
    add_warnings(plan.warnings, context, result);
    add_notes(plan.notes, context, result);
  }
  const InputFacts inputs = ranks.is_root() ? input_facts(arguments) : InputFacts{};
  if (ranks.count() == 1 && keeps_outputs(plan, inputs, arguments, result)) {
    result.report.timings.total = watch.seconds();
    write_job_report(arguments, result);
    return result;
  }
  if (ranks.is_root()) {
    if (!plan.output_folder.empty() && !arguments.dry_run) {
      std::filesystem::create_directories(plan.output_folder);
    }
    ranks.wait_for_all();
  }
  run_volumes(arguments, plan, context, ranks, result);
  gather_results(ranks, result);
  result.report.timings.total = watch.seconds();
  if (!ranks.is_root()) return result;
  add_warnings(step_warnings(arguments.mesh_file(), std::ssize(plan.mesh.header().times),
                             result.report.steps),
               context, result);
  add_notes(storing_notes(result.report), context, result);
  write_provenance(arguments, inputs, plan.outputs(), result);
  write_job_report(arguments, result);
  return result;
}

std::string report_json(const JobResult& result) {
  auto json = nlohmann::ordered_json::parse(to_json(result.report));
  json["status"] = !result.plans.empty() ? "planned" : result.written == 0 ? "skipped" : "done";
  json["outputs"] = result.outputs;
  json["outputs_skipped"] = result.skipped;
  json["warnings"] = result.warnings;
  json["notes"] = result.notes;
  for (const StepPlan& plan : result.plans) {
    json["plans"].push_back({{"volume", plan.volume},
                             {"step", plan.step},
                             {"dims", plan.dims},
                             {"memory", plan.memory},
                             {"blocks", plan.blocks},
                             {"largest_block", plan.largest_block},
                             {"largest_window", plan.largest_window},
                             {"bytes_read", plan.bytes_read},
                             {"disk", plan.disk}});
  }
  return json_text(json, 2);
}

std::string summary(const JobResult& result) {
  const Report& report = result.report;
  const Counts& counts = report.counts;
  std::string text;
  for (const StepPlan& plan : result.plans) text += plan_text(plan);
  if (!result.plans.empty()) return text;
  text += fmt::format("{} written", result.written);
  if (result.skipped > 0) text += fmt::format(", {} skipped", result.skipped);
  if (!result.steps.empty()) text += fmt::format(" ({})", result.steps);
  if (counts.voxels > 0) {
    text += fmt::format(", {} of {} voxels covered", counts.covered, counts.voxels);
  }
  text += fmt::format(", {:.2f} s on {}: {}", report.timings.total, name_of(report.backend),
                      result.outputs.front());
  if (result.outputs.size() > 1) text += " to " + result.outputs.back();
  return text + "\n";
}

}  // namespace tetwarp::cli

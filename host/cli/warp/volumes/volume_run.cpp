/// @file volume_run.cpp
/// The steps of a volume: which are computed, and which --resume keeps.
#include "host/cli/warp/volumes/volume_run.hpp"

#include <algorithm>
#include <vector>

#include "host/base/stopwatch.hpp"
#include "host/cli/common/interrupt.hpp"
#include "host/cli/job/disk_plan.hpp"
#include "host/cli/job/memory_plan.hpp"
#include "host/cli/job/output_files.hpp"
#include "host/cli/warp/volumes/series_in_parts.hpp"
#include "io/files/leftover_files.hpp"

namespace tetwarp::cli {

VolumeRun::VolumeRun(const WarpArguments& arguments,
                     const JobPlan& plan,
                     const VolumePlan& volume,
                     Ranks& ranks,
                     ProgressBar& bar,
                     JobResult& result)
    : task_(arguments, plan, volume, ranks.count()),
      ranks_(ranks),
      bar_(bar),
      result_(result),
      sources_(task_, result.report),
      blocks_(task_, ranks),
      writer_(task_),
      steps_(task_, sources_, blocks_, writer_, ranks, bar, result) {}

void VolumeRun::run() {
  if (task_.volume.is_series) {
    run_series();
  } else {
    run_each_step();
  }
}

void VolumeRun::plan_only() {
  const VolumePlan& volume = task_.volume;
  for (const WarpStep& planned : volume.steps) {
    stop_if_interrupted();
    StepPlan step{volume.path, planned.number, volume.written_grid.dims};
    if (task_.is_whole || !volume.refusal.empty()) {
      step.memory = volume.memory;
      step.disk = temporary_disk(volume, task_.arguments, task_.is_whole ? 0 : 2);
      result_.plans.push_back(step);
      continue;
    }
    const BlockPlan plan = blocks_.plan(task_.job.mesh.read_step(planned.mesh_step), [] {});
    step.blocks = std::ssize(plan.blocks);
    step.disk = temporary_disk(volume, task_.arguments, step.blocks);
    for (const WarpBlock& block : plan.blocks) {
      const std::int64_t window = block.source.voxel_count();
      step.memory = std::max(step.memory, blocks_.fixed_bytes() + block.host_bytes);
      step.largest_block = std::max(step.largest_block, block.output.voxel_count());
      step.largest_window = std::max(step.largest_window, window);
      step.bytes_read += static_cast<double>(window) * voxel_bytes(volume.arrays);
    }
    result_.plans.push_back(step);
  }
}

void VolumeRun::run_each_step() {
  const VolumePlan& volume = task_.volume;
  for (std::size_t s = 0; s < volume.steps.size(); ++s) {
    const Fingerprint inputs = take_sources(volume.steps[s].volume_step);
    const std::shared_ptr<VolumeStep> step = read_step(volume.steps[s]);
    step->output = volume.outputs[s];
    step->fingerprint = inputs;
    step->fingerprint.add(step->positions);
    const bool keeps = may_keep(step->output, step->fingerprint);
    steps_.start_writing();
    if (!keeps) {
      steps_.run(step);
      continue;
    }
    steps_.finish_all();
    bar_.skip_steps(1);
    if (ranks_.is_root()) add_step(step->report, result_.report);
  }
  stop_if_interrupted();
  bar_.show_phase("writing");
  steps_.finish_all();
}

void VolumeRun::run_series() {
  const std::string& output = task_.volume.outputs.front();
  const Fingerprint fingerprint = fingerprint_of_series();
  if (may_keep(output, fingerprint)) {
    bar_.skip_steps(task_.volume.steps.size());
    return;
  }
  if (ranks_.count() == 1 && may_resume_within(task_.volume, task_.arguments)) {
    // The run that writes the parts reads the sources itself.
    sources_.clear();
    blocks_.clear();
    write_series_in_parts(task_, fingerprint, ranks_, bar_, result_);
    return;
  }
  if (ranks_.is_root()) writer_.begin_series(output, fingerprint);
  for (const WarpStep& planned : task_.volume.steps) {
    take_sources(planned.volume_step);
    const std::shared_ptr<VolumeStep> step = read_step(planned);
    step->time = planned.time;
    steps_.start_writing();
    steps_.run(step);
  }
  stop_if_interrupted();
  bar_.show_phase("writing");
  steps_.finish_all();
  if (!ranks_.is_root()) return;
  const Stopwatch watch;
  result_.report.counts += writer_.finish();
  result_.report.timings.write += watch.seconds();
  result_.written += task_.volume.files_per_output();
}

/// Makes a step of the volume the source of the steps that follow, unless it is that already. All
/// that depends on the one before is finished and discarded.
/// @returns what the outputs depend on, except for positions
Fingerprint VolumeRun::take_sources(std::int64_t source_step) {
  if (!sources_.are_of(source_step)) {
    steps_.finish_all();
    steps_.reset();
    bar_.show_phase("reading");
    sources_.take(source_step, blocks_.host_bytes(), ranks_.is_root());
  }
  return sources_.fingerprint();
}

/// Several sources are read twice: here, and to be warped.
Fingerprint VolumeRun::fingerprint_of_series() {
  const std::vector<WarpStep>& steps = task_.volume.steps;
  Fingerprint fingerprint = take_sources(steps.front().volume_step);
  for (const WarpStep& step : steps) {
    stop_if_interrupted();
    if (task_.arguments.pair || task_.volume.has_one_deformation) {
      fingerprint.add(take_sources(step.volume_step).text());
    }
    fingerprint.add(step.time);
    fingerprint.add(task_.job.mesh.read_step(step.mesh_step));
  }
  return fingerprint;
}

/// Reads the positions of a step. Waits for the thread for files.
std::shared_ptr<VolumeStep> VolumeRun::read_step(const WarpStep& planned) {
  stop_if_interrupted();
  steps_.finish_writing();
  auto step = std::make_shared<VolumeStep>();
  step->report.step = planned.number;
  const Stopwatch watch;
  step->positions = task_.job.mesh.read_step(planned.mesh_step);
  step->report.timings.read = watch.seconds();
  if (task_.is_whole) {
    step->report.counts.bytes_read =
        static_cast<std::int64_t>(step->positions.size() * sizeof(Point3));
  }
  return step;
}

/// Whether --resume keeps a file, as determined by the root.
bool VolumeRun::may_keep(const std::string& output, const Fingerprint& fingerprint) {
  const bool may = ranks_.shared(
      ranks_.is_root() &&
      is_up_to_date(task_.arguments, files_of_output(output, task_.outputs), fingerprint));
  if (may && ranks_.is_root()) {
    result_.skipped += task_.volume.files_per_output();
    remove_leftovers_once(output.substr(0, output.rfind('/') + 1));
  }
  return may;
}

}  // namespace tetwarp::cli

/// @file volume_run.cpp
/// Sources, steps and files of a run.
#include "host/cli/warp/volume_run.hpp"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "host/base/stopwatch.hpp"
#include "host/base/warp_backend.hpp"
#include "host/cli/common/interrupt.hpp"
#include "host/cli/warp/memory_plan.hpp"
#include "host/cli/warp/output_files.hpp"
#include "host/cli/warp/source_scan.hpp"
#include "io/files/leftover_files.hpp"
#include "io/files/memory.hpp"

namespace tetwarp::cli {
VolumeRun::VolumeRun(const WarpArguments& arguments,
                     const JobPlan& plan,
                     const VolumePlan& volume,
                     Ranks& ranks,
                     ProgressBar& bar,
                     JobResult& result)
    : arguments_(arguments),
      plan_(plan),
      volume_(volume),
      ranks_(ranks),
      bar_(bar),
      result_(result),
      options_(warp_options(arguments, plan, volume)),
      region_(arguments.warp.region.value_or(Region{{0, 0, 0}, volume.output_grid.dims})),
      is_whole_(volume.memory_limit == 0 && ranks.count() == 1),
      writes_beside_(!is_whole_ || volume.writes_beside),
      overlaps_(is_whole_ && volume.overlaps),
      outputs_(arrays_written(volume, arguments)) {
  if (is_whole_) return;
  // glibc returns the memory of a block to the system when it is freed.
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
  options_.skip.unchanged_tets = false;  // a block is not computed twice
  open_readers(arguments.source_step_of(plan.steps.front()));
  planner_.emplace(volume.source_grid, plan.mesh.mesh(), options_);
  fixed_bytes_ = fixed_memory(volume, arguments, plan.mesh.header());
}

void VolumeRun::run() {
  if (arguments_.temporal) {
    run_temporal();
  } else {
    run_each_step();
  }
}

void VolumeRun::plan_only() {
  for (const std::int64_t number : plan_.steps) {
    stop_if_interrupted();
    StepPlan step{volume_.path, number, volume_.written_grid.dims};
    if (is_whole_) {
      step.memory = volume_.memory;
      step.disk = temporary_disk(volume_, arguments_, 0);
      result_.plans.push_back(step);
      continue;
    }
    const BlockPlan plan = plan_step(plan_.mesh.read_step(number));
    step.blocks = std::ssize(plan.blocks);
    step.disk = temporary_disk(volume_, arguments_, step.blocks);
    for (const WarpBlock& block : plan.blocks) {
      const std::int64_t window = block.source.voxel_count();
      step.memory = std::max(step.memory, fixed_bytes_ + block.host_bytes);
      step.largest_block = std::max(step.largest_block, block.output.voxel_count());
      step.largest_window = std::max(step.largest_window, window);
      step.bytes_read += static_cast<double>(window) * voxel_bytes(volume_.arrays);
    }
    result_.plans.push_back(step);
  }
}

void VolumeRun::open_readers(std::int64_t source_step) {
  readers_.clear();
  for (const ArrayHeader& array : volume_.arrays) {
    readers_.emplace_back(volume_.path, array.name, source_step, volume_.read);
  }
}

/// Makes a step of the volume the source of the steps that follow, unless it is that already. All
/// that depends on the one before is finished and discarded.
/// @returns what the outputs depend on, except for positions
Fingerprint VolumeRun::take_sources(std::int64_t source_step) {
  if (source_step_ == source_step) return inputs_;
  finish_all();
  warper_.reset();
  last_.reset();
  const Stopwatch watch;
  bar_.show_phase("reading");
  if (is_whole_) {
    inputs_ = read_sources(source_step);
  } else {
    open_readers(source_step);
    inputs_ = scan_sources();
  }
  source_step_ = source_step;
  result_.report.timings.read += watch.seconds();
  return inputs_;
}

/// Reads the sources of a whole volume.
/// @returns as take_sources()
Fingerprint VolumeRun::read_sources(std::int64_t source_step) {
  Fingerprint fingerprint = fingerprint_of_options(arguments_, plan_, volume_);
  sources_.clear();
  for (const ArrayHeader& array : volume_.arrays) {
    stop_if_interrupted();
    Volume source = read_volume(volume_.path, array.name, source_step, volume_.read);
    result_.report.counts.bytes_read += static_cast<std::int64_t>(source.data.size());
    fingerprint.add(source);
    sources_.push_back(std::move(source));
  }
  return fingerprint;
}

/// Reads the sources part by part, for --resume and their ranges.
/// @returns as take_sources(), at the root
Fingerprint VolumeRun::scan_sources() {
  Fingerprint fingerprint = fingerprint_of_options(arguments_, plan_, volume_);
  const bool needs_range = arguments_.warp.overshoot == Overshoot::clamp;
  ranges_.resize(readers_.size());
  if (!ranks_.is_root() && !needs_range) return fingerprint;
  const double bytes = std::clamp(0.5 * limits().host, 1e6, 2.5e8);
  for (std::size_t s = 0; s < readers_.size(); ++s) {
    ranges_[s] = scan_source(readers_[s], bytes, needs_range, fingerprint);
    result_.report.counts.bytes_read += static_cast<std::int64_t>(
        bytes_of(volume_.arrays[s], {{0, 0, 0}, volume_.source_grid.dims}));
  }
  return fingerprint;
}

void VolumeRun::run_each_step() {
  for (std::size_t s = 0; s < volume_.steps.size(); ++s) {
    const Fingerprint inputs = take_sources(arguments_.source_step_of(volume_.steps[s]));
    const std::shared_ptr<Step> step = read_step(volume_.steps[s]);
    step->output = volume_.outputs[s];
    step->fingerprint = inputs;
    step->fingerprint.add(step->positions);
    const bool keeps = may_keep(step->output, step->fingerprint);
    start_writing();
    if (keeps) {
      finish_all();
      bar_.skip_steps(1);
      finish_step(step->report);
    } else {
      run_step(step);
    }
  }
  stop_if_interrupted();
  bar_.show_phase("writing");
  finish_all();
}

void VolumeRun::run_temporal() {
  const std::vector<double>& times = plan_.mesh.header().times;
  // With --pair the sources are read twice: here for the fingerprint, and to be warped.
  Fingerprint fingerprint = take_sources(arguments_.source_step_of(plan_.steps.front()));
  for (const std::int64_t step : plan_.steps) {
    stop_if_interrupted();
    if (arguments_.pair) {
      fingerprint.add(take_sources(arguments_.source_step_of(step)).text());
    }
    fingerprint.add(times[static_cast<std::size_t>(step)]);
    fingerprint.add(plan_.mesh.read_step(step));
  }
  const std::string& output = volume_.outputs.front();
  if (may_keep(output, fingerprint)) {
    bar_.skip_steps(plan_.steps.size());
    return;
  }
  const bool is_alone = ranks_.count() == 1;
  if (is_alone && may_resume_within(volume_, arguments_)) return run_in_parts(fingerprint);
  begin_file(output, fingerprint, true);
  for (const std::int64_t number : plan_.steps) {
    take_sources(arguments_.source_step_of(number));
    const std::shared_ptr<Step> step = read_step(number);
    step->time = times[static_cast<std::size_t>(number)];
    start_writing();
    run_step(step);
  }
  stop_if_interrupted();
  bar_.show_phase("writing");
  finish_all();
  const Stopwatch watch;
  if (!writer_) return;
  result_.report.counts += counts_of(writer_->finish());
  result_.report.timings.write += watch.seconds();
  result_.written += files_per_output();
}

/// Reads the positions of a step. @pre the thread for files is idle
std::shared_ptr<VolumeRun::Step> VolumeRun::read_step(std::int64_t number) {
  stop_if_interrupted();
  finish_writing();
  auto step = std::make_shared<Step>();
  step->report.step = number;
  const Stopwatch watch;
  step->positions = plan_.mesh.read_step(number);
  step->report.timings.read = watch.seconds();
  if (is_whole_) {
    step->report.counts.bytes_read =
        static_cast<std::int64_t>(step->positions.size() * sizeof(Point3));
  }
  return step;
}

/// Whether --resume keeps a file, as determined by the root.
bool VolumeRun::may_keep(const std::string& output, const Fingerprint& fingerprint) {
  const bool may =
      ranks_.shared(ranks_.is_root() &&
                    is_up_to_date(arguments_, files_of_output(output, outputs_), fingerprint));
  if (may && ranks_.is_root()) {
    result_.skipped += files_per_output();
    remove_leftovers_once(output.substr(0, output.rfind('/') + 1));
  }
  return may;
}

std::int64_t VolumeRun::files_per_output() const {
  return std::ssize(volume_.files) / std::ssize(volume_.outputs);
}

void VolumeRun::begin_file(const std::string& output,
                           const Fingerprint& fingerprint,
                           bool is_temporal) {
  if (!ranks_.is_root()) return;
  writer_.emplace(output, volume_.written_grid, outputs_,
                  write_options(arguments_, volume_, fingerprint), is_temporal,
                  is_whole_ ? ChunkShape::rows : ChunkShape::bricks);
}

/// Adds a step that is complete to the report of the job.
void VolumeRun::finish_step(const StepReport& report) {
  if (!ranks_.is_root()) return;
  Report& total = result_.report;
  total.timings += report.timings;
  total.counts += report.counts;
  total.steps.push_back(report);
  total.steps.back().timings.total += report.timings.read + report.timings.write;
}

BlockLimits VolumeRun::limits() const {
  BlockLimits limits;
  if (volume_.memory_limit > 0) limits.host = volume_.memory_limit - fixed_bytes_;
  if (plan_.backend == Backend::cuda) limits.device = 0.9 * free_device_memory(options_.device);
  // With several blocks per rank the ranks finish at nearly the same time.
  constexpr std::int64_t blocks_per_rank = 4;
  if (ranks_.count() > 1) {
    limits.max_voxels = volume_.written_grid.voxel_count() / (blocks_per_rank * ranks_.count()) + 1;
  }
  limits.source_voxel = voxel_bytes(volume_.arrays);
  limits.output_voxel = voxel_bytes(outputs_);
  limits.scratch_voxel = plan_.backend == Backend::reference ? 30 : 0;
  limits.step = block_step(volume_.written_grid, outputs_);
  return limits;
}

BlockPlan VolumeRun::plan_step(const std::vector<Point3>& positions) {
  if (is_whole_) {
    WarpBlock whole;
    whole.output = region_;
    return {{whole}};
  }
  BlockLimits common = limits();
  common.host = ranks_.smallest(common.host);
  common.device = ranks_.smallest(common.device);
  try {
    return planner_->plan(positions, common);
  } catch (const std::invalid_argument&) {
    check_limit(positions, common);
    throw;
  }
}

/// Throws std::invalid_argument with the least limit when --memory is too low for the smallest
/// blocks of these positions.
void VolumeRun::check_limit(const std::vector<Point3>& positions, const BlockLimits& limits) {
  double least = least_block_memory(*planner_, positions, limits);
  if (least <= limits.host) return;
  finish_writing();  // HDF5 may be used by one thread at a time
  for (const std::int64_t step : plan_.steps) {
    least = std::max(least, least_block_memory(*planner_, plan_.mesh.read_step(step), limits));
  }
  throw std::invalid_argument(fmt::format(
      "{}: --memory is too low: the program takes {}, a block and its source {} more; give at "
      "least {}",
      volume_.path, bytes_text(fixed_bytes_), bytes_text(least),
      limit_text(std::min(fixed_bytes_ + least, volume_.memory))));
}

}  // namespace tetwarp::cli

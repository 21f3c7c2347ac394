/// @file volume_run.cpp
#include "host/cli/volume_run.hpp"

#include <utility>

#include "host/cli/interrupt.hpp"
#include "host/cli/output_files.hpp"
#include "host/cli/stopwatch.hpp"

namespace tetwarp::cli {

namespace {

std::int64_t bytes_of(const std::vector<Point3>& positions) {
  return static_cast<std::int64_t>(positions.size() * sizeof(Point3));
}

}  // namespace

VolumeRun::VolumeRun(const WarpArguments& arguments,
                     const JobPlan& plan,
                     const VolumePlan& volume,
                     ProgressBar& bar,
                     JobResult& result)
    : arguments_(arguments), plan_(plan), volume_(volume), bar_(bar), result_(result) {}

void VolumeRun::run() {
  read_sources();
  if (arguments_.temporal) {
    write_temporal();
  } else {
    write_each_step();
  }
}

void VolumeRun::read_sources() {
  const Stopwatch watch;
  for (const ArrayHeader& array : volume_.arrays) {
    stop_if_interrupted();
    sources_.push_back(read_volume(volume_.path, array.name, arguments_.source_step));
    result_.report.counts.bytes_read += static_cast<std::int64_t>(sources_.back().data.size());
  }
  result_.report.timings.read += watch.seconds();
}

void VolumeRun::write_each_step() {
  const Fingerprint inputs = fingerprint_of_inputs();
  for (std::size_t s = 0; s < volume_.steps.size(); ++s) {
    stop_if_interrupted();
    finish_writing();
    StepReport report;
    report.step = volume_.steps[s];
    std::vector<Point3> positions = read_positions(report.step, report);
    Fingerprint fingerprint = inputs;
    fingerprint.add(positions);
    const std::string& output = volume_.outputs[s];
    const bool skips = is_up_to_date(arguments_, output, fingerprint);
    start_writing();
    if (skips) {
      finish_computing();
      start_writing();
      finish_writing();
      ++result_.skipped;
      finish_step(report);
      continue;
    }
    const auto write = [&output, options = write_options(arguments_, fingerprint)](
                           const StepReport&, const std::vector<const Volume*>& volumes) {
      return write_volumes(output, volumes, options);
    };
    compute(std::move(positions), report, write);
  }
  write_the_rest();
}

void VolumeRun::write_temporal() {
  Fingerprint fingerprint = fingerprint_of_inputs();
  const std::vector<double>& times = plan_.mesh.header().times;
  for (const std::int64_t step : plan_.steps) {
    stop_if_interrupted();
    fingerprint.add(times[static_cast<std::size_t>(step)]);
    fingerprint.add(plan_.mesh.read_step(step));
  }
  const std::string& output = volume_.outputs.front();
  if (is_up_to_date(arguments_, output, fingerprint)) {
    ++result_.skipped;
    return;
  }
  temporal_.emplace(output, write_options(arguments_, fingerprint));
  for (const std::int64_t step : plan_.steps) {
    stop_if_interrupted();
    finish_writing();
    StepReport report;
    report.step = step;
    std::vector<Point3> positions = read_positions(step, report);
    start_writing();
    const double time = times[static_cast<std::size_t>(step)];
    const auto write = [this, time](const StepReport& step_report,
                                    const std::vector<const Volume*>& volumes) {
      const Counts& counts = step_report.counts;
      const bool keeps_forward =
          !arguments_.extra.contains(forward_output) || counts.tets_unchanged == counts.tetrahedra;
      if (counts.steps_unchanged > 0 ||
          (counts.cells > 0 && counts.cells_unchanged == counts.cells && keeps_forward)) {
        temporal_->repeat(time);
      } else {
        temporal_->append(time, volumes);
      }
      return WrittenFile{};
    };
    compute(std::move(positions), report, write);
  }
  write_the_rest();
  const Stopwatch watch;
  result_.report.counts += counts_of(temporal_->finish());
  result_.report.timings.write += watch.seconds();
  ++result_.written;
}

std::vector<Point3> VolumeRun::read_positions(std::int64_t step, StepReport& report) const {
  const Stopwatch watch;
  std::vector<Point3> positions = plan_.mesh.read_step(step);
  report.timings.read = watch.seconds();
  report.counts.bytes_read = bytes_of(positions);
  return positions;
}

bool VolumeRun::equals_last_step(const std::vector<Point3>& positions) const {
  return arguments_.warp.skip.unchanged_steps && positions == last_positions_;
}

void VolumeRun::compute(std::vector<Point3> positions, StepReport report, Write write) {
  if (equals_last_step(positions)) {
    finish_computing();
    repeat_report(last_report_, report);
    computed_ = Step{report, std::move(write), outputs_[now_].volumes()};
    return;
  }
  if (!warper_) start_warper();
  if (volume_.writes_beside) now_ = 1 - now_;
  Outputs& outputs = outputs_[now_];
  if (outputs.warped.empty()) make_outputs(outputs);
  std::vector<void*> pointers;
  for (Volume& volume : outputs.warped) pointers.push_back(volume.data.data());
  WarpTarget target;
  target.volumes = pointers;
  target.holds_previous = true;
  auto extra = outputs.extra.begin();
  for (const std::size_t e : arguments_.extra) extra_outputs[e].set(target, (extra++)->data.data());
  const auto step_voxels = static_cast<double>(volume_.written_grid.voxel_count());
  const bool writes = writing_.valid();
  const auto steps_done = static_cast<double>(result_.report.steps.size() + (writes ? 1 : 0));
  const auto voxels_done = static_cast<double>(result_.report.counts.voxels +
                                               (writes ? writing_report_.counts.voxels : 0));
  const Progress progress = [&](double share) {
    bar_.update(steps_done + share, voxels_done + share * step_voxels);
    return !is_interrupted();
  };
  last_positions_.clear();  // an interrupted step leaves the outputs undefined
  warper_->begin_step(positions, target, progress);
  last_positions_ = std::move(positions);
  finish_computing();
  begun_ = Step{report, std::move(write), outputs.volumes()};
  if (!volume_.overlaps) finish_computing();
}

/// Throws what went wrong with the step.
void VolumeRun::finish_computing() {
  if (!begun_) return;
  Step step = *std::exchange(begun_, {});
  const StepReport read = step.report;
  step.report = warper_->finish_step();
  step.report.step = read.step;
  step.report.timings.read += read.timings.read;
  step.report.counts.bytes_read += read.counts.bytes_read;
  last_report_ = step.report;
  computed_ = std::move(step);
  if (volume_.overlaps) start_writing();
}

void VolumeRun::start_warper() {
  const std::vector<VolumeView> views(sources_.begin(), sources_.end());
  warper_.emplace(views, plan_.mesh.mesh(), warp_options(arguments_, plan_, volume_));
  const Report& report = warper_->report();
  result_.report.device = report.device;
  result_.report.threads = report.threads;
  result_.report.position_quantum = report.position_quantum;
}

void VolumeRun::make_outputs(Outputs& outputs) const {
  const Grid& grid = warper_->output_grid();
  for (const Volume& source : sources_) {
    outputs.warped.push_back(make_volume(grid, source.type, source.components, source.name));
  }
  for (const std::size_t e : arguments_.extra) {
    const ExtraOutput& extra = extra_outputs[e];
    outputs.extra.push_back(make_volume(grid, extra.type, extra.components, extra.array()));
  }
  if (plan_.backend != Backend::cuda) return;
  const auto lock = [&](Volume& volume) {
    outputs.locks.emplace_back(volume.data.data(), volume.data.size());
  };
  for (Volume& volume : outputs.warped) lock(volume);
  for (Volume& volume : outputs.extra) lock(volume);
}

std::vector<const Volume*> VolumeRun::Outputs::volumes() const {
  std::vector<const Volume*> all;
  for (const Volume& volume : warped) all.push_back(&volume);
  for (const Volume& volume : extra) all.push_back(&volume);
  return all;
}

void VolumeRun::start_writing() {
  if (!computed_) return;
  writing_report_ = computed_->report;
  writing_ = std::async(std::launch::async, [step = *std::exchange(computed_, {})] {
    const Stopwatch watch;
    const WrittenFile file = step.write(step.report, step.volumes);
    return Written{file, watch.seconds()};
  });
  if (!volume_.writes_beside) finish_writing();
}

/// Throws what the write threw.
void VolumeRun::finish_writing() {
  if (!writing_.valid()) return;
  const Written written = writing_.get();
  writing_report_.counts += counts_of(written.file);
  writing_report_.timings.write = written.seconds;
  if (!temporal_) ++result_.written;
  finish_step(writing_report_);
}

void VolumeRun::write_the_rest() {
  stop_if_interrupted();
  finish_writing();
  finish_computing();
  start_writing();
  finish_writing();
}

void VolumeRun::finish_step(const StepReport& report) {
  Report& total = result_.report;
  total.timings += report.timings;
  total.counts += report.counts;
  total.steps.push_back(report);
  total.steps.back().timings.total += report.timings.read + report.timings.write;
  bar_.update(static_cast<double>(total.steps.size()), static_cast<double>(total.counts.voxels));
}

Fingerprint VolumeRun::fingerprint_of_inputs() const {
  Fingerprint fingerprint = fingerprint_of_options(arguments_, plan_, volume_);
  for (const Volume& source : sources_) fingerprint.add(source);
  return fingerprint;
}

}  // namespace tetwarp::cli

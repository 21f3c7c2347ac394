/// @file volume_run.cpp
#include "host/cli/volume_run.hpp"

#include <tetwarp/version.hpp>
#include <utility>

#include "host/cli/interrupt.hpp"
#include "host/cli/stopwatch.hpp"

namespace tetwarp::cli {

namespace {

std::int64_t bytes_of(const std::vector<Point3>& positions) {
  return static_cast<std::int64_t>(positions.size() * sizeof(Point3));
}

void add_written(const WrittenFile& file, Counts& counts) {
  counts.bytes_written += file.bytes;
  counts.chunks_background += file.chunks_background;
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
  for (std::size_t s = 0; s < plan_.steps.size(); ++s) {
    stop_if_interrupted();
    StepReport report;
    report.step = plan_.steps[s];
    std::vector<Point3> positions = read_positions(report.step, report);
    Fingerprint fingerprint = inputs;
    fingerprint.add(positions);
    const std::string& output = volume_.outputs[s];
    if (is_up_to_date(output, fingerprint.text())) {
      ++result_.skipped;
    } else {
      compute(std::move(positions), report);
      stop_if_interrupted();
      const Stopwatch watch;
      add_written(write_volumes(output, targets(), write_options(fingerprint)), report.counts);
      report.timings.write = watch.seconds();
      ++result_.written;
    }
    finish_step(report);
  }
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
  if (is_up_to_date(output, fingerprint.text())) {
    ++result_.skipped;
    return;
  }
  TemporalVolumeWriter writer(output, write_options(fingerprint));
  for (const std::int64_t step : plan_.steps) {
    stop_if_interrupted();
    StepReport report;
    report.step = step;
    std::vector<Point3> positions = read_positions(step, report);
    compute(std::move(positions), report);
    const Counts& counts = report.counts;
    const bool repeats =
        counts.steps_unchanged > 0 || (counts.cells > 0 && counts.cells_unchanged == counts.cells);
    stop_if_interrupted();
    const Stopwatch watch;
    const double time = times[static_cast<std::size_t>(step)];
    if (repeats) {
      writer.repeat(time);
    } else {
      writer.append(time, targets());
    }
    report.timings.write = watch.seconds();
    finish_step(report);
  }
  const Stopwatch watch;
  add_written(writer.finish(), result_.report.counts);
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

bool VolumeRun::is_up_to_date(const std::string& output, const std::string& fingerprint) const {
  return arguments_.resume && read_fingerprint(output) == fingerprint;
}

bool VolumeRun::equals_last_step(const std::vector<Point3>& positions) const {
  return arguments_.warp.skip.unchanged_steps && positions == last_positions_;
}

void VolumeRun::compute(std::vector<Point3> positions, StepReport& report) {
  const StepReport read = report;
  if (equals_last_step(positions)) {
    // The outputs hold this step already: what describes them stays, no work was done.
    const Counts& last = last_report_.counts;
    report.counts.voxels = last.voxels;
    report.counts.covered = last.covered;
    report.counts.outside = last.outside;
    report.counts.tetrahedra = last.tetrahedra;
    report.counts.inverted = last.inverted;
    report.counts.flat = last.flat;
    report.counts.folded = last.folded;
    report.counts.cells = last.cells;
    report.counts.steps_unchanged = 1;
    return;
  }
  if (!warper_) start_warper();
  std::vector<void*> pointers;
  for (Volume& volume : warped_) pointers.push_back(volume.data.data());
  WarpTarget target;
  target.volumes = pointers;
  target.holds_previous = true;
  if (mask_) target.mask = mask_->samples<std::uint8_t>().data();
  if (tet_) target.tet = tet_->samples<std::int32_t>().data();
  const auto step_voxels = static_cast<double>(volume_.written_grid.voxel_count());
  const auto steps_done = static_cast<double>(result_.report.steps.size());
  const Progress progress = [&](double share) {
    const auto voxels_done = static_cast<double>(result_.report.counts.voxels);
    bar_.update(steps_done + share, voxels_done + share * step_voxels);
    return !is_interrupted();
  };
  last_positions_.clear();  // an interrupted step leaves the outputs undefined
  report = warper_->step(positions, target, progress);
  last_positions_ = std::move(positions);
  report.step = read.step;
  report.timings.read += read.timings.read;
  report.counts.bytes_read += read.counts.bytes_read;
  last_report_ = report;
}

void VolumeRun::start_warper() {
  WarpOptions options = arguments_.warp;
  options.backend = plan_.backend;
  options.output_grid = volume_.output_grid;
  const std::vector<VolumeView> views(sources_.begin(), sources_.end());
  warper_.emplace(views, plan_.mesh.mesh(), options);
  const Report& report = warper_->report();
  result_.report.device = report.device;
  result_.report.threads = report.threads;
  result_.report.position_quantum = report.position_quantum;
  const Grid& grid = warper_->output_grid();
  for (const Volume& source : sources_) {
    warped_.push_back(make_volume(grid, source.type, source.components, source.name));
  }
  if (arguments_.extra.mask) mask_ = make_volume(grid, PixelType::uint8, 1, mask_array_name);
  if (arguments_.extra.tet) tet_ = make_volume(grid, PixelType::int32, 1, tet_array_name);
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
  Fingerprint fingerprint;
  const WarpOptions& warp = arguments_.warp;
  fingerprint.add(TETWARP_VERSION);
  fingerprint.add(plan_.backend);
  fingerprint.add(warp.filter);
  fingerprint.add(warp.outside);
  fingerprint.add(warp.background);
  fingerprint.add(arguments_.extra.mask);
  fingerprint.add(arguments_.extra.tet);
  fingerprint.add(volume_.output_grid);
  fingerprint.add(volume_.written_grid);
  for (const Volume& source : sources_) fingerprint.add(source);
  fingerprint.add(plan_.mesh.mesh().tets);
  fingerprint.add(plan_.mesh.mesh().rest_positions);
  return fingerprint;
}

std::vector<const Volume*> VolumeRun::targets() const {
  std::vector<const Volume*> volumes;
  for (const Volume& volume : warped_) volumes.push_back(&volume);
  if (mask_) volumes.push_back(&*mask_);
  if (tet_) volumes.push_back(&*tet_);
  return volumes;
}

VolumeWriteOptions VolumeRun::write_options(const Fingerprint& fingerprint) const {
  return {.compress = arguments_.compress,
          .background = arguments_.warp.background,
          .skip_background_chunks = arguments_.warp.skip.background_chunks,
          .fingerprint = fingerprint.text()};
}

}  // namespace tetwarp::cli

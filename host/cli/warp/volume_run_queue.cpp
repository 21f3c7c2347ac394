/// @file volume_run_queue.cpp
/// Blocks between computing and file: finished, written, or sent to the root.
#include <utility>

#include "host/base/stopwatch.hpp"
#include "host/cli/warp/output_files.hpp"
#include "host/cli/warp/report_exchange.hpp"
#include "host/cli/warp/volume_run.hpp"

namespace tetwarp::cli {
namespace {
/// In the indices of a grid whose voxel 0 is voxel `origin` of the region's.
Region moved(const Region& region, const std::array<std::int64_t, 3>& origin) {
  Region moved = region;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    moved.begin[axis] -= origin[axis];
    moved.end[axis] -= origin[axis];
  }
  return moved;
}

/// Whether the outputs of a step equal those of the previous one.
bool changes_nothing(const Counts& counts, const ExtraChoice& extra) {
  const bool keeps_forward =
      !extra.contains(forward_output) || counts.tets_unchanged == counts.tetrahedra;
  return counts.cells > 0 && counts.cells_unchanged == counts.cells && keeps_forward;
}
}  // namespace

/// @throws the error of the step
void VolumeRun::finish_computing() {
  if (!begun_) return;
  Part part = *std::exchange(begun_, {});
  const StepReport computed = warper_->finish_step();
  Step& step = *part.step;
  step.report.timings += computed.timings;
  step.report.counts += computed.counts;
  step.report.totals = computed.totals;
  if (is_whole_) {
    step.is_repeat = arguments_.temporal && changes_nothing(step.report.counts, arguments_.extra);
  }
  computed_ = std::move(part);
  if (overlaps_) start_writing();
}

void VolumeRun::start_writing() {
  if (!computed_) return;
  finish_writing();
  if (computed_->is_last && arguments_.strict) {
    refuse_warnings(step_warnings(arguments_.mesh_file(), {&computed_->step->report, 1}));
  }
  writing_part_ = *std::exchange(computed_, {});
  writing_ = files_.run([this, part = writing_part_] { write(part); });
  if (!writes_beside_) {
    bar_.show_phase("writing");
    finish_writing();
  }
}

/// @throws the error of the write
void VolumeRun::finish_writing() {
  if (!writing_.valid()) return;
  writing_.get();
  const Part part = std::exchange(writing_part_, {});
  if (!part.is_last) return;
  StepReport& report = part.step->report;
  report.counts += part.step->written;
  report.timings.write += part.step->write_seconds;
  if (!part.step->output.empty()) result_.written += files_per_output();
  finish_step(report);
  bar_.finish_step();
  bar_.update(0, static_cast<double>(result_.report.counts.voxels));
}

void VolumeRun::finish_all() {
  start_writing();
  finish_computing();
  start_writing();
  finish_writing();
}

/// Runs on the thread for files.
void VolumeRun::write(const Part& part) {
  const Stopwatch watch;
  Step& step = *part.step;
  const bool has_own_file = !step.output.empty();
  if (part.is_first && has_own_file) {
    begin_file(step.output, step.fingerprint, false);
  } else if (part.is_first && step.is_repeat) {
    writer_->repeat_step(step.time);
  } else if (part.is_first) {
    writer_->begin_step(step.time);
  }
  const Region region = moved(part.region, region_.begin);
  for (std::size_t a = 0; !step.is_repeat && a < outputs_.size(); ++a) {
    writer_->write(a, region, (*part.outputs)[a].get());
  }
  if (part.is_last && has_own_file) {
    step.written = counts_of(writer_->finish());
    writer_.reset();
  }
  step.write_seconds += watch.seconds();
}

/// Waits until the root has received the previous block.
void VolumeRun::send(const Part& part) {
  ranks_.finish_sending();
  sent_ = part.outputs;
  for (std::size_t a = 0; a < sent_->size(); ++a) {
    ranks_.send({(*sent_)[a].get(), bytes_of(outputs_[a], part.region)});
  }
}

std::shared_ptr<VolumeRun::Samples> VolumeRun::receive(const Region& region, int from) const {
  auto outputs = std::make_shared<Samples>(make_outputs(region));
  for (std::size_t a = 0; a < outputs->size(); ++a) {
    ranks_.receive(from, {(*outputs)[a].get(), bytes_of(outputs_[a], region)});
  }
  return outputs;
}

void VolumeRun::add_reports_of_others(StepReport& report) const {
  const std::vector<std::string> reports = ranks_.gather(text_of(report));
  for (std::size_t r = 1; r < reports.size(); ++r) {
    const StepReport other = step_report_of(reports[r]);
    report.timings += other.timings;
    report.counts += other.counts;
  }
}

}  // namespace tetwarp::cli

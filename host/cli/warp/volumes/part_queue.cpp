/// @file part_queue.cpp
/// Begins and ends the writing of blocks.
#include "host/cli/warp/volumes/part_queue.hpp"

#include <utility>

#include "host/cli/job/output_files.hpp"
#include "host/cli/job/warnings.hpp"

namespace tetwarp::cli {

void PartQueue::start_writing() {
  if (!computed_) return;
  finish_writing();
  if (computed_->is_last && task_.arguments.strict) {
    refuse_warnings(step_warnings(task_.arguments.mesh_file(),
                                  std::ssize(task_.job.mesh.header().times),
                                  {&computed_->step->report, 1}));
  }
  writing_part_ = take_computed();
  writing_ = files_.run([this, part = writing_part_] { writer_.write(part); });
  if (!task_.writes_beside) {
    bar_.show_phase("writing");
    finish_writing();
  }
}

void PartQueue::finish_writing() {
  if (!writing_.valid()) return;
  writing_.get();
  const VolumePart part = std::exchange(writing_part_, {});
  if (!part.is_last) return;
  StepReport& report = part.step->report;
  report.counts += part.step->written;
  report.timings.write += part.step->write_seconds;
  if (!part.step->output.empty()) result_.written += task_.volume.files_per_output();
  add_step(report, result_.report);
  bar_.finish_step();
  bar_.update(0, static_cast<double>(result_.report.counts.voxels));
}

}  // namespace tetwarp::cli

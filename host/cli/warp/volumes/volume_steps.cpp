/// @file volume_steps.cpp
/// Blocks in order: windows are read, computed, sent or written.
#include "host/cli/warp/volumes/volume_steps.hpp"

#include <stdexcept>
#include <utility>

#include "host/cli/common/interrupt.hpp"
#include "host/cli/job/output_files.hpp"

namespace tetwarp::cli {
namespace {
/// A tetrahedron counts once, independent of the number of its blocks.
void describe(const BlockPlan& plan, Counts& counts) {
  counts.blocks = std::ssize(plan.blocks);
  counts.tetrahedra = plan.tetrahedra;
  counts.inverted = plan.inverted;
  counts.flat = plan.flat;
}
}  // namespace

VolumeSteps::VolumeSteps(const VolumeTask& task,
                         const VolumeSources& sources,
                         VolumeBlocks& blocks,
                         StepWriter& writer,
                         Ranks& ranks,
                         ProgressBar& bar,
                         JobResult& result)
    : task_(task),
      sources_(sources),
      blocks_(blocks),
      ranks_(ranks),
      bar_(bar),
      result_(result),
      exchange_(task, ranks),
      warper_(task, sources, result.report),
      queue_(task, writer, bar, result) {}

void VolumeSteps::run(const std::shared_ptr<VolumeStep>& step) {
  if (equals_last(*step)) {
    repeat_last(step);
  } else {
    step->plan = plan(step->positions);
    run_blocks(step);
  }
}

void VolumeSteps::finish_all() {
  queue_.start_writing();
  queue_.finish_writing();
}

void VolumeSteps::reset() {
  warper_.reset();
  last_.reset();
}

bool VolumeSteps::equals_last(const VolumeStep& step) const {
  return task_.arguments.warp.expert.skip.unchanged_steps && last_ != nullptr &&
         step.positions == last_->positions;
}

void VolumeSteps::repeat_last(const std::shared_ptr<VolumeStep>& step) {
  if (!ranks_.is_root()) return;
  repeat_report(last_->report, step->report);
  step->is_repeat = task_.volume.is_series;
  queue_.add({step, task_.region, warper_.last_outputs()});
  if (!task_.is_whole) finish_all();
}

BlockPlan VolumeSteps::plan(const std::vector<Point3>& positions) {
  // HDF5 may be used by one thread at a time.
  return blocks_.plan(positions, [this] { queue_.finish_writing(); });
}

void VolumeSteps::run_blocks(const std::shared_ptr<VolumeStep>& step) {
  const std::vector<WarpBlock>& blocks = step->plan.blocks;
  const auto stride = static_cast<std::size_t>(ranks_.count());
  std::future<SourceWindows> next = begin_reading(*step, static_cast<std::size_t>(ranks_.rank()));
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const int owner = static_cast<int>(b % stride);
    if (owner != ranks_.rank() && !ranks_.is_root()) continue;
    VolumePart part{step, blocks[b].output, {}, b == 0, b + 1 == blocks.size()};
    if (owner != ranks_.rank()) {
      part.outputs = exchange_.receive(part.region, owner);
      const bool is_last = part.is_last;
      queue_.add(std::move(part));
      if (!is_last) queue_.start_writing();
      continue;
    }
    SourceWindows windows;
    if (next.valid()) windows = next.get();
    step->report.timings.read += windows.seconds;
    next = begin_reading(*step, b + stride);
    compute(std::move(part), blocks[b], windows.samples);
  }
  // With one file per step blocks are computed again, because their outputs are not kept.
  if (task_.is_whole || task_.volume.is_series) last_ = step;
  if (!task_.is_whole) end_step_of_blocks(*step);
}

/// Begins to read the windows of a block; a whole volume has its sources in memory.
std::future<SourceWindows> VolumeSteps::begin_reading(const VolumeStep& step, std::size_t block) {
  if (task_.is_whole || block >= step.plan.blocks.size()) return {};
  return queue_.files().run(
      [this, window = step.plan.blocks[block].source] { return sources_.read(window); });
}

/// Computes a block and, of several, begins to write it or sends it to the root.
void VolumeSteps::compute(VolumePart part, const WarpBlock& block, const Samples& windows) {
  const Progress progress = progress_of(part);
  const bool is_last = part.is_last;
  queue_.add(warper_.compute(std::move(part), block, windows, progress));
  if (task_.is_whole) return;
  if (!ranks_.is_root()) {
    exchange_.send(queue_.take_computed());
  } else if (!is_last) {
    queue_.start_writing();
  }
}

/// Writes the last block, when all counts of the step are known.
void VolumeSteps::end_step_of_blocks(VolumeStep& step) {
  exchange_.finish_sending();
  exchange_.add_reports(step.report);
  describe(step.plan, step.report.counts);
  step.plan = {};
  queue_.start_writing();
  queue_.finish_writing();
}

Progress VolumeSteps::progress_of(const VolumePart& part) const {
  const auto before = static_cast<double>(part.step->report.counts.voxels);
  double steps_done = 0;
  double voxels_done = static_cast<double>(result_.report.counts.voxels) + before;
  // Earlier steps that are not finished yet: computed, being written.
  const VolumeStep* later = part.step.get();
  const VolumeStep* const computed = queue_.computed() ? queue_.computed()->step.get() : nullptr;
  for (const VolumeStep* step : {computed, queue_.writing()}) {
    if (step == nullptr || step == later || step == part.step.get()) continue;
    steps_done += 1;
    voxels_done += static_cast<double>(step->report.counts.voxels);
    later = step;
  }
  const auto voxels = static_cast<double>(part.region.voxel_count());
  const double all = static_cast<double>(task_.volume.written_grid.voxel_count()) / ranks_.count();
  return [=, &bar = bar_](double share) {
    bar.update(steps_done + (before + share * voxels) / all, voxels_done + share * voxels);
    return !is_interrupted();
  };
}

}  // namespace tetwarp::cli

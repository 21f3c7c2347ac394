/// @file volume_run_step.cpp
/// Reads and computes the blocks of a step.
#include <algorithm>
#include <future>
#include <utility>

#include "host/base/stopwatch.hpp"
#include "host/cli/common/interrupt.hpp"
#include "host/cli/warp/output_files.hpp"
#include "host/cli/warp/volume_run.hpp"

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

void VolumeRun::run_step(const std::shared_ptr<Step>& step) {
  if (equals_last_step(*step)) {
    repeat_step(step);
  } else {
    step->plan = plan_step(step->positions);
    run_blocks(step);
  }
}

bool VolumeRun::equals_last_step(const Step& step) const {
  return arguments_.warp.skip.unchanged_steps && last_ != nullptr &&
         step.positions == last_->positions;
}

void VolumeRun::repeat_step(const std::shared_ptr<Step>& step) {
  finish_computing();
  if (!ranks_.is_root()) return;
  repeat_report(last_->report, step->report);
  step->is_repeat = arguments_.temporal;
  computed_ = Part{step, region_, kept_[now_]};
  if (!is_whole_) finish_all();
}

void VolumeRun::run_blocks(const std::shared_ptr<Step>& step) {
  const std::vector<WarpBlock>& blocks = step->plan.blocks;
  const auto stride = static_cast<std::size_t>(ranks_.count());
  std::future<Windows> next = begin_reading(*step, static_cast<std::size_t>(ranks_.rank()));
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const int owner = static_cast<int>(b % stride);
    if (owner != ranks_.rank() && !ranks_.is_root()) continue;
    Part part{step, blocks[b].output, {}, b == 0, b + 1 == blocks.size()};
    if (owner != ranks_.rank()) {
      part.outputs = receive(part.region, owner);
      computed_ = std::move(part);
      if (!computed_->is_last) start_writing();
      continue;
    }
    Windows windows;
    if (next.valid()) windows = next.get();
    step->report.timings.read += windows.seconds;
    next = begin_reading(*step, b + stride);
    compute(std::move(part), blocks[b], windows.samples);
  }
  // With one file per step blocks are computed again, because their outputs are not kept.
  if (is_whole_ || arguments_.temporal) last_ = step;
  if (is_whole_) return;
  ranks_.finish_sending();
  sent_.reset();
  add_reports_of_others(step->report);
  describe(step->plan, step->report.counts);
  step->plan = {};
  start_writing();  // the last block, when all counts of the step are known
  finish_writing();
}

/// Begins to read the windows of a block; a whole volume has its sources in memory.
std::future<VolumeRun::Windows> VolumeRun::begin_reading(const Step& step, std::size_t block) {
  if (is_whole_ || block >= step.plan.blocks.size()) return {};
  return files_.run([this, window = step.plan.blocks[block].source] {
    const Stopwatch watch;
    Windows windows{read_windows(window)};
    windows.seconds = watch.seconds();
    return windows;
  });
}

/// Begins a block, finishes the previous one and, unless steps overlap, this one.
void VolumeRun::compute(Part part, const WarpBlock& block, const Samples& windows) {
  if (!is_whole_ || !warper_) make_warper(block, windows);
  part.outputs = outputs_for(part.region);
  std::vector<void*> volumes;
  for (std::size_t s = 0; s < volume_.arrays.size(); ++s) {
    volumes.push_back((*part.outputs)[s].get());
  }
  WarpTarget target;
  target.volumes = volumes;
  target.holds_previous = is_whole_;
  std::size_t extra = volumes.size();
  for (const std::size_t e : arguments_.extra) {
    extra_outputs[e].set(target, (*part.outputs)[extra++].get());
  }
  const std::vector<Point3>& positions = part.step->positions;
  const std::vector<Point3> of_block =
      part_mesh_ ? part_mesh_->of(positions) : std::vector<Point3>();
  warper_->begin_step(part_mesh_ ? of_block : positions, target, progress_of(part));
  finish_computing();
  begun_ = std::move(part);
  if (!overlaps_) finish_computing();
  if (is_whole_) return;
  warper_.reset();
  part_mesh_.reset();
  for (const ArrayHeader& array : volume_.arrays) {
    const auto bytes = static_cast<std::int64_t>(bytes_of(array, block.source));
    computed_->step->report.counts.bytes_read += bytes;
  }
  if (target.owner != nullptr) {
    std::for_each_n(target.owner, block.output.voxel_count(), [&](std::int32_t& t) {
      if (t >= 0) t = block.cells[static_cast<std::size_t>(t)];
    });
  }
  if (ranks_.is_root()) {
    if (!computed_->is_last) start_writing();
  } else {
    send(*std::exchange(computed_, {}));
  }
}

void VolumeRun::make_warper(const WarpBlock& block, const Samples& windows) {
  if (is_whole_) {
    const std::vector<VolumeView> views(sources_.begin(), sources_.end());
    warper_.emplace(views, plan_.mesh.mesh(), options_);
  } else {
    std::vector<VolumeView> views;
    for (std::size_t s = 0; s < windows.size(); ++s) {
      const ArrayHeader& array = volume_.arrays[s];
      views.emplace_back(volume_.source_grid, array.type, array.components, windows[s].get(),
                         Memory::host);
    }
    options_.region = block.output;
    options_.source_window = SourceWindow{block.source, ranges_};
    part_mesh_ = block_mesh(plan_.mesh.mesh(), block);
    warper_.emplace(views, part_mesh_->mesh, options_);
  }
  const Report& report = warper_->report();
  result_.report.device = report.device;
  result_.report.threads = report.threads;
  result_.report.position_quantum = report.position_quantum;
}

/// New memory for a block. For a whole volume the two sets of kept_ in turns, or a single one where
/// a step is not computed before the previous one is written.
std::shared_ptr<VolumeRun::Samples> VolumeRun::outputs_for(const Region& region) {
  if (!is_whole_) return std::make_shared<Samples>(make_outputs(region));
  if (writes_beside_) now_ = 1 - now_;
  std::shared_ptr<Samples>& kept = kept_[now_];
  if (kept != nullptr) return kept;
  kept = std::make_shared<Samples>(make_outputs(region));
  for (std::size_t a = 0; a < outputs_.size() && plan_.backend == Backend::cuda; ++a) {
    locks_.emplace_back((*kept)[a].get(), bytes_of(outputs_[a], region));
  }
  return kept;
}

Progress VolumeRun::progress_of(const Part& part) const {
  const auto before = static_cast<double>(part.step->report.counts.voxels);
  double steps_done = 0;
  double voxels_done = static_cast<double>(result_.report.counts.voxels) + before;
  // Earlier steps that are not finished yet: in flight on a device, computed, being written.
  const Step* later = part.step.get();
  for (const Step* step :
       {begun_ ? begun_->step.get() : later, computed_ ? computed_->step.get() : later,
        writing_.valid() ? writing_part_.step.get() : later}) {
    if (step == later || step == part.step.get()) continue;
    steps_done += 1;
    voxels_done += static_cast<double>(step->report.counts.voxels);
    later = step;
  }
  const auto voxels = static_cast<double>(part.region.voxel_count());
  const double all = static_cast<double>(volume_.written_grid.voxel_count()) / ranks_.count();
  return [=, &bar = bar_](double share) {
    bar.update(steps_done + (before + share * voxels) / all, voxels_done + share * voxels);
    return !is_interrupted();
  };
}

VolumeRun::Samples VolumeRun::read_windows(const Region& window) const {
  Samples windows;
  for (const VolumeReader& reader : readers_) {
    windows.push_back(
        std::make_unique_for_overwrite<std::byte[]>(bytes_of(reader.array(), window)));
    reader.read(window, windows.back().get());
  }
  return windows;
}

VolumeRun::Samples VolumeRun::make_outputs(const Region& region) const {
  Samples outputs;
  for (const ArrayHeader& array : outputs_) {
    outputs.push_back(std::make_unique_for_overwrite<std::byte[]>(bytes_of(array, region)));
  }
  return outputs;
}

}  // namespace tetwarp::cli

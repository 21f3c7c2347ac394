/// @file block_run.cpp
#include "host/cli/block_run.hpp"

#include <malloc.h>

#include <algorithm>
#include <utility>

#include "host/base/warp_backend.hpp"
#include "host/cli/interrupt.hpp"
#include "host/cli/output_files.hpp"
#include "host/cli/source_scan.hpp"
#include "host/cli/stopwatch.hpp"
#include "io/memory.hpp"
#include "kernels/base/hex_view.hpp"

namespace tetwarp::cli {

namespace {

double voxel_bytes(const std::vector<ArrayHeader>& arrays) {
  double bytes = 0;
  for (const ArrayHeader& array : arrays) {
    bytes += array.components * static_cast<double>(size_of(array.type));
  }
  return bytes;
}

/// A tetrahedron counts once, however many blocks it meets.
void describe(const BlockPlan& plan, Counts& counts) {
  counts.blocks = std::ssize(plan.blocks);
  counts.tetrahedra = plan.tetrahedra;
  counts.inverted = plan.inverted;
  counts.flat = plan.flat;
}

}  // namespace

BlockRun::BlockRun(const WarpArguments& arguments,
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
      outputs_(volume.arrays) {
  // Memory of a block goes back when it is done with.
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
  options_.skip.unchanged_tets = false;  // a block is not computed twice
  for (const std::size_t e : arguments.extra) {
    const ExtraOutput& extra = extra_outputs[e];
    outputs_.push_back({extra.array(), extra.type, extra.components});
  }
  for (const ArrayHeader& array : volume.arrays) {
    readers_.emplace_back(volume.path, array.name, arguments.source_step);
  }
  planner_.emplace(volume.source_grid, plan.mesh.mesh(), options_);
  fixed_bytes_ = fixed_bytes();
}

void BlockRun::run() {
  const Stopwatch watch;
  Fingerprint inputs = scan_sources();
  result_.report.timings.read += watch.seconds();
  if (arguments_.temporal) {
    run_temporal(inputs);
  } else {
    run_each_step(inputs);
  }
}

void BlockRun::plan_only() {
  for (const std::int64_t number : plan_.steps) {
    stop_if_interrupted();
    const BlockPlan plan = plan_step(plan_.mesh.read_step(number));
    StepPlan step{volume_.path, number, volume_.written_grid.dims};
    step.blocks = std::ssize(plan.blocks);
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

Fingerprint BlockRun::scan_sources() {
  Fingerprint fingerprint = fingerprint_of_options(arguments_, plan_, volume_);
  const bool wants_range = arguments_.warp.overshoot == Overshoot::clamp;
  ranges_.resize(readers_.size());
  if (!ranks_.is_root() && !wants_range) return fingerprint;
  const double bytes = std::clamp(0.5 * limits().host, 1e6, 2.5e8);
  for (std::size_t s = 0; s < readers_.size(); ++s) {
    const VolumeReader& reader = readers_[s];
    ranges_[s] = scan_source(reader, bytes, wants_range, fingerprint);
    result_.report.counts.bytes_read +=
        static_cast<std::int64_t>(bytes_of(reader.array(), {{0, 0, 0}, reader.grid().dims}));
  }
  return fingerprint;
}

void BlockRun::run_each_step(const Fingerprint& inputs) {
  for (std::size_t s = 0; s < volume_.steps.size(); ++s) {
    stop_if_interrupted();
    StepReport report;
    report.step = volume_.steps[s];
    const std::vector<Point3> positions = plan_.mesh.read_step(report.step);
    Fingerprint fingerprint = inputs;
    fingerprint.add(positions);
    if (may_keep(volume_.outputs[s], fingerprint)) {
      finish_step(report);
      continue;
    }
    const BlockPlan plan = plan_step(positions);
    begin_file(volume_.outputs[s], fingerprint, false);
    run_step(plan, positions, report);
    report.counts += finish_file();
    describe(plan, report.counts);
    finish_step(report);
  }
}

void BlockRun::run_temporal(Fingerprint fingerprint) {
  const std::vector<double>& times = plan_.mesh.header().times;
  for (const std::int64_t step : plan_.steps) {
    stop_if_interrupted();
    fingerprint.add(times[static_cast<std::size_t>(step)]);
    fingerprint.add(plan_.mesh.read_step(step));
  }
  const std::string& output = volume_.outputs.front();
  if (may_keep(output, fingerprint)) return;
  begin_file(output, fingerprint, true);
  std::vector<Point3> last_positions;
  for (const std::int64_t step : plan_.steps) {
    stop_if_interrupted();
    StepReport report;
    report.step = step;
    std::vector<Point3> positions = plan_.mesh.read_step(step);
    const double time = times[static_cast<std::size_t>(step)];
    if (arguments_.warp.skip.unchanged_steps && positions == last_positions) {
      if (writer_) {
        writer_->repeat_step(time);
        repeat_report(result_.report.steps.back(), report);
      }
    } else {
      const BlockPlan plan = plan_step(positions);
      if (writer_) writer_->begin_step(time);
      run_step(plan, positions, report);
      describe(plan, report.counts);
    }
    finish_step(report);
    last_positions = std::move(positions);
  }
  result_.report.counts += finish_file();
}

/// The root decides, and writes.
bool BlockRun::may_keep(const std::string& output, const Fingerprint& fingerprint) {
  const bool may =
      ranks_.shared(ranks_.is_root() && is_up_to_date(arguments_, output, fingerprint));
  if (may && ranks_.is_root()) ++result_.skipped;
  return may;
}

void BlockRun::begin_file(const std::string& output,
                          const Fingerprint& fingerprint,
                          bool is_temporal) {
  if (!ranks_.is_root()) return;
  writer_.emplace(output, volume_.written_grid, outputs_, write_options(arguments_, fingerprint),
                  is_temporal);
}

Counts BlockRun::finish_file() {
  if (!writer_) return {};
  const Counts counts = counts_of(writer_->finish());
  writer_.reset();
  ++result_.written;
  return counts;
}

double BlockRun::fixed_bytes() const {
  // What is there, the mesh included, and what planning, threads and files take: footprints, lists
  // of tetrahedra, positions in several forms; chunks.
  const MeshHeader& mesh = plan_.mesh.header();
  double bytes = resident_memory() + 8e6 +
                 160 * static_cast<double>(mesh.tet_count + tets_per_hex * mesh.hex_count) +
                 120 * static_cast<double>(mesh.node_count);
  for (const VolumeReader& reader : readers_) bytes += reader.chunk_bytes() + 1e6;
  return bytes;
}

BlockLimits BlockRun::limits() const {
  BlockLimits limits;
  if (volume_.memory_limit > 0) limits.host = volume_.memory_limit - fixed_bytes_;
  if (plan_.backend == Backend::cuda) limits.device = 0.9 * free_device_memory(options_.device);
  // Enough blocks to share out, the last of which keep few waiting.
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

BlockPlan BlockRun::plan_step(const std::vector<Point3>& positions) {
  BlockLimits common = limits();
  common.host = ranks_.least(common.host);
  common.device = ranks_.least(common.device);
  return planner_->plan(positions, common);
}

void BlockRun::finish_step(const StepReport& report) {
  if (!ranks_.is_root()) return;
  Report& total = result_.report;
  total.timings += report.timings;
  total.counts += report.counts;
  total.steps.push_back(report);
  bar_.update(static_cast<double>(total.steps.size()), static_cast<double>(total.counts.voxels));
}

}  // namespace tetwarp::cli

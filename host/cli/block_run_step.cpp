/// @file block_run_step.cpp
/// One step in blocks: files on a thread of their own, this one computes.
#include <algorithm>
#include <future>
#include <utility>

#include "host/cli/block_run.hpp"
#include "host/cli/interrupt.hpp"
#include "host/cli/io_thread.hpp"
#include "host/cli/stopwatch.hpp"

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

}  // namespace

void BlockRun::run_step(const BlockPlan& plan,
                        const std::vector<Point3>& positions,
                        BlockVolumeWriter& writer,
                        StepReport& report) {
  double read_seconds = 0, write_seconds = 0;  // of the thread for files
  {
    IoThread files;
    const auto read = [&](const WarpBlock& block) {
      return files.run([this, &block, &read_seconds] {
        const Stopwatch watch;
        Samples windows = read_window(block.source);
        read_seconds += watch.seconds();
        return windows;
      });
    };
    std::future<Samples> next = read(plan.blocks.front());
    std::future<void> written;
    for (std::size_t b = 0; b < plan.blocks.size(); ++b) {
      const WarpBlock& block = plan.blocks[b];
      Samples windows = next.get();
      for (const ArrayHeader& array : volume_.arrays) {
        report.counts.bytes_read += static_cast<std::int64_t>(bytes_of(array, block.source));
      }
      if (b + 1 < plan.blocks.size()) next = read(plan.blocks[b + 1]);
      auto outputs = std::make_shared<const Samples>(compute(block, positions, windows, report));
      windows.clear();
      if (written.valid()) written.get();
      written = files.run([this, &block, &writer, &write_seconds, outputs = std::move(outputs)] {
        const Stopwatch watch;
        write(block.output, *outputs, writer);
        write_seconds += watch.seconds();
      });
    }
    written.get();
  }
  report.timings.read += read_seconds;
  report.timings.write += write_seconds;
}

BlockRun::Samples BlockRun::read_window(const Region& window) const {
  Samples windows;
  for (const VolumeReader& reader : readers_) {
    windows.push_back(
        std::make_unique_for_overwrite<std::byte[]>(bytes_of(reader.array(), window)));
    reader.read(window, windows.back().get());
  }
  return windows;
}

BlockRun::Samples BlockRun::make_outputs(const Region& region) const {
  Samples outputs;
  for (const ArrayHeader& array : outputs_) {
    outputs.push_back(std::make_unique_for_overwrite<std::byte[]>(bytes_of(array, region)));
  }
  return outputs;
}

BlockRun::Samples BlockRun::compute(const WarpBlock& block,
                                    const std::vector<Point3>& positions,
                                    const Samples& windows,
                                    StepReport& report) {
  std::vector<VolumeView> sources;
  for (std::size_t s = 0; s < windows.size(); ++s) {
    const ArrayHeader& array = volume_.arrays[s];
    VolumeView& view = sources.emplace_back(volume_.source_grid, array.type, array.components,
                                            windows[s].get(), Memory::host);
    view.window = block.source;
    view.range = ranges_[s];
  }
  Samples outputs = make_outputs(block.output);
  std::vector<void*> volumes;
  for (std::size_t s = 0; s < windows.size(); ++s) volumes.push_back(outputs[s].get());
  std::size_t extra = windows.size();
  WarpTarget target{.volumes = volumes};
  for (const std::size_t e : arguments_.extra) set_extra_output(target, e, outputs[extra++].get());

  options_.region = block.output;
  const BlockMesh part = block_mesh(plan_.mesh.mesh(), block);
  Warper warper(sources, part.mesh, options_);
  const auto steps_done = static_cast<double>(result_.report.steps.size());
  const auto voxels_done = static_cast<double>(result_.report.counts.voxels + report.counts.voxels);
  const auto voxels = static_cast<double>(block.output.voxel_count());
  const auto before = static_cast<double>(report.counts.voxels);
  const auto all = static_cast<double>(volume_.written_grid.voxel_count());
  const StepReport step = warper.step(part.of(positions), target, [&](double share) {
    bar_.update(steps_done + (before + share * voxels) / all, voxels_done + share * voxels);
    return !is_interrupted();
  });
  report.timings += step.timings;
  report.counts += step.counts;
  if (target.tet != nullptr) {
    std::for_each_n(target.tet, block.output.voxel_count(), [&](std::int32_t& t) {
      if (t >= 0) t = block.cells[static_cast<std::size_t>(t)];
    });
  }
  result_.report.device = warper.report().device;
  result_.report.threads = warper.report().threads;
  result_.report.position_quantum = warper.report().position_quantum;
  return outputs;
}

void BlockRun::write(const Region& region,
                     const Samples& outputs,
                     BlockVolumeWriter& writer) const {
  const Region written = moved(region, arguments_.warp.region.value_or(Region{}).begin);
  for (std::size_t a = 0; a < outputs.size(); ++a) writer.write(a, written, outputs[a].get());
}

}  // namespace tetwarp::cli

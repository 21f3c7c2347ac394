/// @file block_run_step.cpp
/// One step in blocks: files on a thread of their own, this one computes.
#include <algorithm>
#include <cstring>
#include <future>
#include <span>
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
                        StepReport& report) {
  double read_seconds = 0, write_seconds = 0;  // of the thread for files
  {
    IoThread files;
    const auto stride = static_cast<std::size_t>(ranks_.count());
    const auto read = [&](std::size_t b) -> std::future<Samples> {
      if (b >= plan.blocks.size()) return {};
      return files.run([this, &window = plan.blocks[b].source, &read_seconds] {
        const Stopwatch watch;
        Samples windows = read_window(window);
        read_seconds += watch.seconds();
        return windows;
      });
    };
    std::future<Samples> next = read(static_cast<std::size_t>(ranks_.rank()));
    std::future<void> written;
    for (std::size_t b = 0; b < plan.blocks.size(); ++b) {
      const WarpBlock& block = plan.blocks[b];
      const int owner = static_cast<int>(b % stride);
      if (owner != ranks_.rank() && !ranks_.is_root()) continue;
      Samples outputs;
      if (owner == ranks_.rank()) {
        const Samples windows = next.get();
        next = read(b + stride);
        outputs = compute(block, positions, windows, report);
      } else {
        outputs = receive(block, owner);
      }
      if (!ranks_.is_root()) {
        send(block, std::move(outputs));
        continue;
      }
      if (written.valid()) written.get();
      written = files.run([this, &block, &write_seconds,
                           samples = std::make_shared<const Samples>(std::move(outputs))] {
        const Stopwatch watch;
        write(block.output, *samples);
        write_seconds += watch.seconds();
      });
    }
    if (written.valid()) written.get();
  }
  report.timings.read += read_seconds;
  report.timings.write += write_seconds;
  ranks_.finish_sending();
  sent_.clear();
  add_reports_of_others(report);
}

/// Waits until the root has the block before.
void BlockRun::send(const WarpBlock& block, Samples outputs) {
  ranks_.finish_sending();
  sent_ = std::move(outputs);
  for (std::size_t a = 0; a < sent_.size(); ++a) {
    ranks_.send({sent_[a].get(), bytes_of(outputs_[a], block.output)});
  }
}

BlockRun::Samples BlockRun::receive(const WarpBlock& block, int from) const {
  Samples outputs = make_outputs(block.output);
  for (std::size_t a = 0; a < outputs.size(); ++a) {
    ranks_.receive(from, {outputs[a].get(), bytes_of(outputs_[a], block.output)});
  }
  return outputs;
}

void BlockRun::add_reports_of_others(StepReport& report) const {
  struct Sums {
    Timings timings;
    Counts counts;
  };
  const Sums mine{report.timings, report.counts};
  const auto reports = ranks_.gather(std::as_bytes(std::span(&mine, 1)));
  for (std::size_t r = 1; r < reports.size(); ++r) {
    Sums other;
    std::memcpy(&other, reports[r].data(), sizeof other);
    report.timings += other.timings;
    report.counts += other.counts;
  }
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
    sources.emplace_back(volume_.source_grid, array.type, array.components, windows[s].get(),
                         Memory::host);
  }
  Samples outputs = make_outputs(block.output);
  std::vector<void*> volumes;
  for (std::size_t s = 0; s < windows.size(); ++s) volumes.push_back(outputs[s].get());
  std::size_t extra = windows.size();
  WarpTarget target{.volumes = volumes};
  for (const std::size_t e : arguments_.extra) extra_outputs[e].set(target, outputs[extra++].get());

  options_.region = block.output;
  options_.source_window = SourceWindow{block.source, ranges_};
  const BlockMesh part = block_mesh(plan_.mesh.mesh(), block);
  Warper warper(sources, part.mesh, options_);
  const auto steps_done = static_cast<double>(result_.report.steps.size());
  const auto voxels_done = static_cast<double>(result_.report.counts.voxels + report.counts.voxels);
  const auto voxels = static_cast<double>(block.output.voxel_count());
  const auto before = static_cast<double>(report.counts.voxels);
  const auto all = static_cast<double>(volume_.written_grid.voxel_count()) / ranks_.count();
  const StepReport step = warper.step(part.of(positions), target, [&](double share) {
    bar_.update(steps_done + (before + share * voxels) / all, voxels_done + share * voxels);
    return !is_interrupted();
  });
  report.timings += step.timings;
  report.counts += step.counts;
  for (const ArrayHeader& array : volume_.arrays) {
    report.counts.bytes_read += static_cast<std::int64_t>(bytes_of(array, block.source));
  }
  if (target.owner != nullptr) {
    std::for_each_n(target.owner, block.output.voxel_count(), [&](std::int32_t& t) {
      if (t >= 0) t = block.cells[static_cast<std::size_t>(t)];
    });
  }
  result_.report.device = warper.report().device;
  result_.report.threads = warper.report().threads;
  result_.report.position_quantum = warper.report().position_quantum;
  return outputs;
}

void BlockRun::write(const Region& region, const Samples& outputs) {
  const Region written = moved(region, arguments_.warp.region.value_or(Region{}).begin);
  for (std::size_t a = 0; a < outputs.size(); ++a) writer_->write(a, written, outputs[a].get());
}

}  // namespace tetwarp::cli

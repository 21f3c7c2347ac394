/// @file volume_sources.cpp
/// Reads sources as a whole or in windows.
#include "host/cli/warp/volumes/volume_sources.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "host/base/stopwatch.hpp"
#include "host/cli/common/interrupt.hpp"
#include "host/cli/job/output_files.hpp"
#include "host/cli/job/source_scan.hpp"

namespace tetwarp::cli {

VolumeSources::VolumeSources(const VolumeTask& task, Report& report)
    : task_(task), report_(report) {
  if (!task.is_whole) open(task.volume.steps.front().volume_step);
}

void VolumeSources::take(std::int64_t step, double host_bytes, bool scans) {
  const Stopwatch watch;
  fingerprint_ = fingerprint_of_options(task_.arguments, task_.job, task_.volume);
  if (task_.is_whole) {
    read_whole(step);
  } else {
    open(step);
    scan(host_bytes, scans);
  }
  step_ = step;
  report_.timings.read += watch.seconds();
}

void VolumeSources::open(std::int64_t step) {
  readers_.clear();
  for (const ArrayHeader& array : task_.volume.arrays) {
    readers_.emplace_back(task_.volume.path, array.name, step, task_.volume.read);
  }
}

void VolumeSources::read_whole(std::int64_t step) {
  whole_.clear();
  for (const ArrayHeader& array : task_.volume.arrays) {
    stop_if_interrupted();
    Volume source = read_volume(task_.volume.path, array.name, step, task_.volume.read);
    report_.counts.bytes_read += static_cast<std::int64_t>(source.data.size());
    fingerprint_.add(source);
    whole_.push_back(std::move(source));
  }
}

void VolumeSources::scan(double host_bytes, bool scans) {
  const bool needs_range = task_.arguments.warp.overshoot == Overshoot::clamp;
  ranges_.resize(readers_.size());
  if (!scans && !needs_range) return;
  const Region all{{0, 0, 0}, task_.volume.source_grid.dims};
  const double bytes = std::clamp(0.5 * host_bytes, 1e6, 2.5e8);
  for (std::size_t s = 0; s < readers_.size(); ++s) {
    ranges_[s] = scan_source(readers_[s], bytes, needs_range, fingerprint_);
    report_.counts.bytes_read += static_cast<std::int64_t>(bytes_of(task_.volume.arrays[s], all));
  }
}

SourceWindows VolumeSources::read(const Region& window) const {
  const Stopwatch watch;
  SourceWindows windows{make_samples(task_.volume.arrays, window)};
  for (std::size_t s = 0; s < readers_.size(); ++s) {
    readers_[s].read(window, windows.samples[s].get());
  }
  windows.seconds = watch.seconds();
  return windows;
}

std::vector<VolumeView> VolumeSources::views_of(const Samples& windows) const {
  std::vector<VolumeView> views;
  for (std::size_t s = 0; s < windows.size(); ++s) {
    const ArrayHeader& array = task_.volume.arrays[s];
    views.emplace_back(task_.volume.source_grid, array.type, array.components, windows[s].get(),
                       Memory::host);
  }
  return views;
}

void VolumeSources::clear() {
  whole_.clear();
  readers_.clear();
  step_ = -1;
}

}  // namespace tetwarp::cli

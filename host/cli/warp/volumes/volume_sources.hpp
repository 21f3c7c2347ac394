/// @file volume_sources.hpp
/// The sources of a volume: the arrays of one step of its file.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/io.hpp>
#include <tetwarp/report.hpp>

#include "host/cli/job/fingerprint.hpp"
#include "host/cli/warp/volumes/samples.hpp"
#include "host/cli/warp/volumes/volume_task.hpp"

namespace tetwarp::cli {

/// Windows of the sources and the seconds that reading them took.
struct SourceWindows {
  Samples samples;
  double seconds = 0;
};

/// Sources of a whole volume are held in memory; those of blocks are read window by window.
class VolumeSources {
 public:
  /// @param task, report  kept by the caller; the report gets the counts of what is read
  VolumeSources(const VolumeTask& task, Report& report);

  /// Whether the sources are those of a step of the volume.
  bool are_of(std::int64_t step) const { return step_ == step; }

  /// Makes a step of the volume the sources.
  /// @param host_bytes  memory that reading blocks may use [byte]
  /// @param scans       of blocks: the sources are read once for fingerprint and ranges; false:
  ///                    only if ranges are needed
  void take(std::int64_t step, double host_bytes, bool scans);

  /// What outputs depend on, except positions: sources and options.
  /// @pre take() with `scans`
  const Fingerprint& fingerprint() const { return fingerprint_; }

  /// Of a whole volume.
  std::vector<VolumeView> views() const { return {whole_.begin(), whole_.end()}; }

  /// Reads one window of each source.
  SourceWindows read(const Region& window) const;
  /// Views of such windows, which must outlive them.
  std::vector<VolumeView> views_of(const Samples& windows) const;
  /// Smallest and largest samples of each source, for --overshoot clamp in blocks.
  const std::vector<std::vector<double>>& ranges() const { return ranges_; }

  /// Frees the memory; take() is needed again.
  void clear();

 private:
  void open(std::int64_t step);
  void read_whole(std::int64_t step);
  void scan(double host_bytes, bool scans);

  const VolumeTask& task_;
  Report& report_;
  std::int64_t step_ = -1;  ///< of the volume; -1: none
  Fingerprint fingerprint_;
  std::vector<Volume> whole_;          ///< of a whole volume
  std::vector<VolumeReader> readers_;  ///< of blocks
  std::vector<std::vector<double>> ranges_;
};

}  // namespace tetwarp::cli

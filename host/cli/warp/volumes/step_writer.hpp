/// @file step_writer.hpp
/// Writes the steps of a volume: all to one temporal file, or each to a file of its own.
#pragma once
#include <optional>
#include <string>

#include "host/cli/job/fingerprint.hpp"
#include "host/cli/job/output_writer.hpp"
#include "host/cli/warp/volumes/volume_part.hpp"
#include "host/cli/warp/volumes/volume_task.hpp"

namespace tetwarp::cli {

/// Used by one thread at a time. @throws IoError
class StepWriter {
 public:
  /// @param task  kept by the caller
  explicit StepWriter(const VolumeTask& task) : task_(task) {}

  /// Begins a temporal file.
  void begin_series(const std::string& output, const Fingerprint& fingerprint) {
    begin_file(output, fingerprint, true);
  }
  /// Writes a block to the temporal file, or to the file of its step, which its first block begins
  /// and its last block ends.
  void write(const VolumePart& part);
  /// Appends a step that equals the one before.
  void repeat_step(double time) { file_->repeat_step(time); }
  /// Appends a step: copies its arrays from a file.
  void copy_step(double time, const std::string& path);
  /// Ends the temporal file. @returns what was written
  Counts finish();

 private:
  void begin_file(const std::string& output, const Fingerprint& fingerprint, bool is_temporal);

  const VolumeTask& task_;
  std::optional<OutputWriter> file_;
};

}  // namespace tetwarp::cli

/// @file part_queue.hpp
/// Blocks between computing and file, and the thread that reads and writes files.
#pragma once
#include <future>
#include <optional>

#include "host/cli/common/progress_bar.hpp"
#include "host/cli/job/io_thread.hpp"
#include "host/cli/job/job_result.hpp"
#include "host/cli/warp/volumes/step_writer.hpp"
#include "host/cli/warp/volumes/volume_part.hpp"
#include "host/cli/warp/volumes/volume_task.hpp"

namespace tetwarp::cli {

/// At most one block is computed and not being written yet, and one is being written. A step is
/// added to the report of the job when its last block is written.
class PartQueue {
 public:
  /// All are kept by the caller.
  PartQueue(const VolumeTask& task, StepWriter& writer, ProgressBar& bar, JobResult& result)
      : task_(task), writer_(writer), bar_(bar), result_(result) {}

  /// Adds a block that is computed. @pre computed() is empty
  void add(VolumePart part) { computed_ = std::move(part); }
  const std::optional<VolumePart>& computed() const { return computed_; }
  /// Removes the block that is computed.
  VolumePart take_computed() { return *std::exchange(computed_, {}); }

  /// The step of the block that is being written; null: none.
  const VolumeStep* writing() const {
    return writing_.valid() ? writing_part_.step.get() : nullptr;
  }

  /// Begins to write the block that is computed, if there is one, after the previous one is
  /// written. With --strict throws std::runtime_error before the last block of a step that has a
  /// warning.
  void start_writing();
  /// Waits until the block that is being written is done. @throws the error of the write
  void finish_writing();

  /// Runs tasks on files. The calling thread uses files only while it is idle.
  IoThread& files() { return files_; }

 private:
  const VolumeTask& task_;
  StepWriter& writer_;
  ProgressBar& bar_;
  JobResult& result_;
  std::optional<VolumePart> computed_;
  VolumePart writing_part_;
  std::future<void> writing_;
  IoThread files_;  ///< last member: its destructor waits for a task that uses the others
};

}  // namespace tetwarp::cli

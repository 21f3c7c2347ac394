/// @file volume_steps.hpp
/// Computes the steps of a volume block by block and passes them on to be written.
#pragma once
#include <cstddef>
#include <future>
#include <memory>
#include <vector>

#include "host/cli/common/progress_bar.hpp"
#include "host/cli/common/ranks.hpp"
#include "host/cli/warp/volumes/block_warper.hpp"
#include "host/cli/warp/volumes/part_exchange.hpp"
#include "host/cli/warp/volumes/part_queue.hpp"
#include "host/cli/warp/volumes/volume_blocks.hpp"
#include "host/cli/warp/volumes/volume_sources.hpp"

namespace tetwarp::cli {

/// The calling thread computes. A second thread reads and writes files; the calling thread does so
/// only while the second one is idle. Blocks are assigned to ranks round-robin, and the root writes
/// them.
///
/// A whole volume: a step is written while the next one is computed and, on a device, copied to the
/// host.
///
/// Several blocks: while a block is computed, the previous one is written and the windows of the
/// next one are read; steps do not overlap.
class VolumeSteps {
 public:
  /// All are kept by the caller.
  VolumeSteps(const VolumeTask& task,
              const VolumeSources& sources,
              VolumeBlocks& blocks,
              StepWriter& writer,
              Ranks& ranks,
              ProgressBar& bar,
              JobResult& result);

  /// Computes a step.
  void run(const std::shared_ptr<VolumeStep>& step);

  /// Begins to write what is computed.
  void start_writing() { queue_.start_writing(); }
  /// Waits for the thread for files.
  void finish_writing() { queue_.finish_writing(); }
  /// Writes all that is computed.
  void finish_all();
  /// The sources change: nothing of earlier steps is reused.
  void reset();

 private:
  bool equals_last(const VolumeStep& step) const;
  void repeat_last(const std::shared_ptr<VolumeStep>& step);
  BlockPlan plan(const std::vector<Point3>& positions);
  void run_blocks(const std::shared_ptr<VolumeStep>& step);
  std::future<SourceWindows> begin_reading(const VolumeStep& step, std::size_t block);
  void compute(VolumePart part, const WarpBlock& block, const Samples& windows);
  void end_step_of_blocks(VolumeStep& step);
  Progress progress_of(const VolumePart& part) const;

  const VolumeTask& task_;
  const VolumeSources& sources_;
  VolumeBlocks& blocks_;
  Ranks& ranks_;
  ProgressBar& bar_;
  JobResult& result_;
  PartExchange exchange_;
  std::shared_ptr<VolumeStep> last_;  ///< the last step, if it may be repeated
  BlockWarper warper_;
  PartQueue queue_;  ///< last member: its thread uses the others
};

}  // namespace tetwarp::cli

/// @file volume_run.hpp
/// One volume file warped by every step of a plan. Reading, computing and writing overlap.
#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include "host/cli/common/progress_bar.hpp"
#include "host/cli/common/ranks.hpp"
#include "host/cli/job/fingerprint.hpp"
#include "host/cli/job/job_plan.hpp"
#include "host/cli/job/job_result.hpp"
#include "host/cli/job/warp_arguments.hpp"
#include "host/cli/warp/volumes/step_writer.hpp"
#include "host/cli/warp/volumes/volume_blocks.hpp"
#include "host/cli/warp/volumes/volume_sources.hpp"
#include "host/cli/warp/volumes/volume_steps.hpp"
#include "host/cli/warp/volumes/volume_task.hpp"

namespace tetwarp::cli {

/// A volume that does not fit in the memory limit, and one that ranks share, is computed in blocks.
/// The arrays of the output files do not depend on the blocks.
class VolumeRun {
 public:
  /// All are kept by the caller.
  VolumeRun(const WarpArguments& arguments,
            const JobPlan& plan,
            const VolumePlan& volume,
            Ranks& ranks,
            ProgressBar& bar,
            JobResult& result);

  /// Reads, warps and writes; adds what was done to the result.
  void run();

  /// For --dry-run: adds a plan per step to the result.
  void plan_only();

 private:
  void run_each_step();
  void run_series();
  Fingerprint take_sources(std::int64_t source_step);
  Fingerprint fingerprint_of_series();
  std::shared_ptr<VolumeStep> read_step(const WarpStep& planned);
  bool may_keep(const std::string& output, const Fingerprint& fingerprint);

  VolumeTask task_;
  Ranks& ranks_;
  ProgressBar& bar_;
  JobResult& result_;
  VolumeSources sources_;
  VolumeBlocks blocks_;
  StepWriter writer_;  ///< of the root
  VolumeSteps steps_;  ///< last member: its threads use the others
};

}  // namespace tetwarp::cli

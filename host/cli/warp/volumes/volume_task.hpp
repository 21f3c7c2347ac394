/// @file volume_task.hpp
/// One volume of a job: what is computed, in which form, and what is written. Constant during a
/// run.
#pragma once
#include <vector>

#include <tetwarp/io.hpp>
#include <tetwarp/warp.hpp>

#include "host/cli/job/job_plan.hpp"
#include "host/cli/job/warp_arguments.hpp"

namespace tetwarp::cli {

struct VolumeTask {
  /// @param arguments, job, volume  kept by the caller
  /// @param rank_count              processes that share the volume
  VolumeTask(const WarpArguments& arguments,
             const JobPlan& job,
             const VolumePlan& volume,
             int rank_count);

  const WarpArguments& arguments;
  const JobPlan& job;
  const VolumePlan& volume;
  bool is_whole;       ///< a single block; sources, Warper and outputs are reused by all steps
  bool writes_beside;  ///< a block is written while the next one is computed
  Region region;       ///< of the output grid: all that is computed
  WarpOptions options;
  std::vector<ArrayHeader> outputs;  ///< warped arrays, then the extra ones
};

}  // namespace tetwarp::cli

/// @file job_share.hpp
/// The part of a job that a rank does, and the sum of the results of all ranks.
#pragma once
#include <cstddef>

#include "host/cli/common/progress_bar.hpp"
#include "host/cli/common/ranks.hpp"
#include "host/cli/job/job_plan.hpp"
#include "host/cli/job/job_result.hpp"
#include "host/cli/job/warp_arguments.hpp"

namespace tetwarp::cli {

/// Warps a volume, or the part of it that is this rank's.
/// @param task  number of the volume's first output among the outputs of the job
void run_volume(const WarpArguments& arguments,
                const JobPlan& plan,
                const VolumePlan& volume,
                Ranks& ranks,
                std::size_t task,
                ProgressBar& bar,
                JobResult& result);

/// For --dry-run: adds a plan per step to the result.
void plan_only(const WarpArguments& arguments,
               const JobPlan& plan,
               const VolumePlan& volume,
               ProgressBar& bar,
               JobResult& result);

/// Adds the results of all ranks to that of the root and sorts the steps by their numbers.
void gather_results(const Ranks& ranks, JobResult& result);

}  // namespace tetwarp::cli

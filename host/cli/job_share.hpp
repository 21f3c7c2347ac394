/// @file job_share.hpp
/// Which part of a job a rank does, and how the parts become one result.
#pragma once
#include <cstddef>

#include "host/cli/job_plan.hpp"
#include "host/cli/progress_bar.hpp"
#include "host/cli/ranks.hpp"
#include "host/cli/warp_job.hpp"

namespace tetwarp::cli {

/// Warps a volume, or this rank's share of it, in memory or in blocks.
/// @param task  number of the volume's first output among those of the job
void run_volume(const WarpArguments& arguments,
                const JobPlan& plan,
                const VolumePlan& volume,
                Ranks& ranks,
                std::size_t task,
                ProgressBar& bar,
                JobResult& result);

/// Only says how, step by step.
void plan_only(const WarpArguments& arguments,
               const JobPlan& plan,
               const VolumePlan& volume,
               ProgressBar& bar,
               JobResult& result);

/// The root's result becomes that of all ranks; its steps come in the order of their numbers.
void gather_results(const Ranks& ranks, JobResult& result);

}  // namespace tetwarp::cli

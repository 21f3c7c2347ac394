/// @file disk_plan.hpp
/// Space on the disk for the temporary files of an output, which are in its folder.
#pragma once
#include <cstdint>
#include <span>

#include "host/cli/job/job_plan.hpp"

namespace tetwarp::cli {

/// What they take in addition to the output [byte]: an unpacked source and unpacked fields, steps
/// of a series that can be resumed, and an output that is packed or put in order when it is
/// complete. Those of all processes of mpirun that work on the volume.
/// @param blocks  of the output; 0: it is computed as a whole
double temporary_disk(const VolumePlan& plan, const WarpArguments& arguments, std::int64_t blocks);

/// Refuses a job, as refuse() does by the plan that takes most, for whose temporary files there is
/// no room in the folder of its outputs. Each process of mpirun works on one volume at a time.
void check_room(std::span<VolumePlan> plans, const WarpArguments& arguments);

}  // namespace tetwarp::cli

/// @file disk_plan.hpp
/// Space on the disk for the temporary files of an output, which are in its folder.
#pragma once
#include <cstdint>

#include "host/cli/job/job_plan.hpp"

namespace tetwarp::cli {

/// What they take in addition to the output [byte]: an unpacked source and unpacked fields, steps
/// of a series that can be resumed, and an output that is packed or put in order when it is
/// complete.
/// @param blocks  of the output; 0: it is computed as a whole
double temporary_disk(const VolumePlan& plan, const WarpArguments& arguments, std::int64_t blocks);

/// Refuses a job, as refuse() does, for whose temporary files the folder has no room.
void check_room(VolumePlan& plan, const WarpArguments& arguments);

}  // namespace tetwarp::cli

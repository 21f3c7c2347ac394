/// @file memory_plan.hpp
/// Whether a volume and its outputs fit in memory.
#pragma once
#include <string>

#include "host/cli/job_plan.hpp"

namespace tetwarp::cli {

/// Why an output cannot be computed in blocks, with a remedy; empty: it can.
std::string needs_all_at_once(const WarpArguments& arguments);

/// Sets `memory` and `memory_limit` of a plan. Sources, outputs and extra outputs must fit in
/// memory, with --memory at least block by block. Throws std::invalid_argument, IoError.
/// @returns whether a second set of outputs also fits
bool plan_memory(VolumePlan& plan, const WarpArguments& arguments);

}  // namespace tetwarp::cli

/// @file memory_plan.hpp
/// Whether memory holds a volume and its output at once.
#pragma once
#include <string>

#include "host/cli/job_plan.hpp"

namespace tetwarp::cli {

/// Why an output cannot be made in blocks, and what would help; empty: it can.
std::string needs_all_at_once(const WarpArguments& arguments);

/// Sets `memory` and `memory_limit` of a plan. Source, output and extra outputs must fit, or blocks
/// of them where a limit is given. Throws std::invalid_argument, IoError.
/// @returns whether the outputs fit once more
bool plan_memory(VolumePlan& plan, const WarpArguments& arguments);

}  // namespace tetwarp::cli

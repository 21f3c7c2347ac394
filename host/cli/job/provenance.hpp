/// @file provenance.hpp
/// Files beside outputs that tell what they were made from.
#pragma once
#include "host/cli/job/job_plan.hpp"
#include "host/cli/job/job_result.hpp"

namespace tetwarp::cli {

/// Writes OUT.json for each file OUT of a job that lacks one or has an older one: the version, the
/// back end, the options as given, and all inputs with their size and SHA-256, as JSON.
/// @throws IoError
void write_provenance(const WarpArguments& arguments, const JobPlan& plan, const JobResult& result);

}  // namespace tetwarp::cli

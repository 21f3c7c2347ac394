/// @file transform_job.hpp
/// `tetwarp warp` by a displacement field or an affine transform instead of a mesh.
#pragma once
#include <string>
#include <vector>

#include "host/cli/job/job_result.hpp"
#include "host/cli/job/warp_arguments.hpp"

namespace tetwarp::cli {

/// True when the last file is a transform.
bool names_transform(const WarpArguments& arguments);

/// Why --axes says nothing about a transform, with a remedy; empty: it is an image of a field,
/// whose axes it may state.
std::string axes_refusal(const std::string& transform);

/// Why run_transform_job() refuses an option with its values, with a remedy; empty: it does not.
/// @param option          its long name without dashes
/// @param has_provenance  --provenance is given, too
std::string transform_refusal(const std::string& option,
                              const std::vector<std::string>& values,
                              bool has_provenance);

/// The files that run_transform_job() writes. Throws IoError.
std::vector<std::string> transform_job_files(const WarpArguments& arguments);

/// Resamples a volume, all steps of a series; with --memory in parts if need be. Options that need
/// a mesh are refused. Throws std::invalid_argument, IoError, Cancelled.
JobResult run_transform_job(const WarpArguments& arguments, const JobContext& context);

/// The lines to print after a job that ran.
std::string transform_summary(const WarpArguments& arguments, const JobResult& result);

}  // namespace tetwarp::cli

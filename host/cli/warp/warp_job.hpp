/// @file warp_job.hpp
/// One warp from files to files: `tetwarp warp` without --batch, or one job of a batch.
#pragma once
#include <string>

#include <tetwarp/report.hpp>

#include "host/cli/job/job_result.hpp"
#include "host/cli/job/warp_arguments.hpp"

namespace tetwarp::cli {

/// Why --count-folded stands alone, with a remedy.
inline constexpr const char* count_folded_refusal = "needs --report, which it adds to; add it";

/// Plans the job, then reads, warps and writes step by step; writes the report last. Nothing is
/// written before all checks of the plan have passed. Throws std::invalid_argument, IoError,
/// CudaError, Cancelled.
///
/// With several ranks the outputs are divided among them; a single output is divided in blocks,
/// which the root writes. The result is complete at the root only.
JobResult run_warp_job(const WarpArguments& arguments, const JobContext& context);

/// The report as JSON, with the fields of the command: "status", "outputs", "outputs_skipped",
/// "warnings", "notes".
std::string report_json(const JobResult& result);

/// A line to print: outputs, covered voxels, seconds, back end and file names. After --dry-run the
/// plan of each output.
std::string summary(const JobResult& result);

}  // namespace tetwarp::cli

/// @file warp_job.hpp
/// One warp from files to files: `tetwarp warp` without --batch, or one job of a batch.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/report.hpp>

#include "host/cli/warp_arguments.hpp"

namespace tetwarp::cli {

/// Where a job runs in.
struct JobContext {
  std::string label = "warp";  ///< names the job in the progress bar
  bool shows_progress = true;
};

/// What a job did.
struct JobResult {
  Report report;
  std::vector<std::string> outputs;  ///< of all steps and volumes, also those skipped
  std::int64_t written = 0;          ///< outputs written
  std::int64_t skipped = 0;          ///< outputs that --resume found complete and up to date
};

/// Plans the job, then reads, warps and writes step by step, reusing every buffer; writes the
/// report last. Nothing is written unless the whole plan is sound. Throws std::invalid_argument,
/// IoError, CudaError, Cancelled.
JobResult run_warp_job(const WarpArguments& arguments, const JobContext& context);

/// The report with what only the command knows: "status", "outputs", "outputs_skipped".
std::string report_json(const JobResult& result);

/// Two lines for people: the back end and why; what was done, how long it took and where it is.
std::string summary(const JobResult& result);

}  // namespace tetwarp::cli

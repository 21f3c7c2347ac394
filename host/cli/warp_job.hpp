/// @file warp_job.hpp
/// One warp from files to files: `tetwarp warp` without --batch, or one job of a batch.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/report.hpp>

#include "host/cli/ranks.hpp"
#include "host/cli/warp_arguments.hpp"

namespace tetwarp::cli {

/// Where a job runs in.
struct JobContext {
  std::string label = "warp";  ///< names the job in the progress bar
  bool shows_progress = true;
  Ranks* ranks = nullptr;  ///< that share the job; null: one process does it
};

/// How one step would be done.
struct StepPlan {
  std::string volume;
  std::int64_t step = 0;
  std::array<std::int64_t, 3> dims{};  ///< of the output
  double memory = 0;                   ///< bytes at a time
  std::int64_t blocks = 0;             ///< 0: all at once
  std::int64_t largest_block = 0;      ///< [voxel]
  std::int64_t largest_window = 0;     ///< of the source [voxel]
  double bytes_read = 0;               ///< of the source
};

/// What a job did.
struct JobResult {
  Report report;
  std::vector<std::string> outputs;  ///< of all steps and volumes, also those skipped
  std::vector<StepPlan> plans;       ///< with --dry-run, which does no more
  std::int64_t written = 0;          ///< outputs written
  std::int64_t skipped = 0;          ///< outputs that --resume found complete and up to date
};

/// Plans the job, then reads, warps and writes step by step, reusing every buffer; writes the
/// report last. Nothing is written unless the whole plan is sound. Throws std::invalid_argument,
/// IoError, CudaError, Cancelled.
///
/// Of several ranks each takes outputs of its own; of a volume with a single output, blocks of it,
/// which the root writes. The result is complete at the root only.
JobResult run_warp_job(const WarpArguments& arguments, const JobContext& context);

/// The report with what only the command knows: "status", "outputs", "outputs_skipped".
std::string report_json(const JobResult& result);

/// Two lines for people: the back end and why; what was done, how long it took and where it is.
std::string summary(const JobResult& result);

}  // namespace tetwarp::cli

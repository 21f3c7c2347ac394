/// @file warp_job.hpp
/// One warp from files to files: `tetwarp warp` without --batch, or one job of a batch.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/report.hpp>

#include "host/cli/common/ranks.hpp"
#include "host/cli/warp/warnings.hpp"
#include "host/cli/warp/warp_arguments.hpp"

namespace tetwarp::cli {

/// Where a job runs.
struct JobContext {
  std::string label = "warp";  ///< names the job in the progress bar and in warnings
  bool shows_progress = true;  ///< and prints warnings
  Ranks* ranks = nullptr;      ///< processes that share the job; null: one process
};

/// The plan of one step, for --dry-run.
struct StepPlan {
  std::string volume;
  std::int64_t step = 0;
  std::array<std::int64_t, 3> dims{};  ///< of the output
  double memory = 0;                   ///< peak [byte]
  std::int64_t blocks = 0;             ///< 0: the whole output at once
  std::int64_t largest_block = 0;      ///< [voxel]
  std::int64_t largest_window = 0;     ///< of the source [voxel]
  double bytes_read = 0;               ///< of the source [byte]
  double disk = 0;                     ///< of temporary files [byte]
};

struct JobResult {
  Report report;
  std::vector<std::string> outputs;  ///< of all steps and volumes, also those skipped
  std::vector<StepPlan> plans;       ///< filled by --dry-run, which does nothing else
  std::string refusal;               ///< with --dry-run: why the job cannot run here
  std::int64_t written = 0;          ///< outputs written
  std::int64_t skipped = 0;          ///< outputs that --resume found complete and up to date
  Warnings warnings;                 ///< in the order in which they were found
};

/// Plans the job, then reads, warps and writes step by step; writes the report last. Nothing is
/// written before all checks of the plan have passed. Throws std::invalid_argument, IoError,
/// CudaError, Cancelled.
///
/// With several ranks the outputs are divided among them; a single output is divided in blocks,
/// which the root writes. The result is complete at the root only.
JobResult run_warp_job(const WarpArguments& arguments, const JobContext& context);

/// The report as JSON, with the fields of the command: "status", "outputs", "outputs_skipped",
/// "warnings".
std::string report_json(const JobResult& result);

/// A line to print: outputs, covered voxels, seconds, back end and file names. After --dry-run the
/// plan of each output.
std::string summary(const JobResult& result);

/// One line to print on standard error after a warp with Intensity::conservative to integers: by
/// how much rounding and clipping changed the total, for the step and component where that is most.
/// Empty if no total has changed.
std::string storing_note(const Report& report);

}  // namespace tetwarp::cli

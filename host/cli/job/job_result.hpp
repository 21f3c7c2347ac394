/// @file job_result.hpp
/// Where a warp from files to files runs, and what comes of it.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/report.hpp>

#include "host/cli/common/ranks.hpp"
#include "host/cli/job/warnings.hpp"

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
  std::string steps;                 ///< what was done with steps, for the summary; empty: no word
  std::vector<StepPlan> plans;       ///< filled by --dry-run, which does nothing else
  std::string refusal;               ///< with --dry-run: why the job cannot run here
  std::int64_t written = 0;          ///< outputs written
  std::int64_t skipped = 0;          ///< outputs that --resume found complete and up to date
  Warnings warnings;                 ///< in the order in which they were found
  Warnings notes;                    ///< facts that are no warnings, likewise
};

/// Adds warnings to the result of a job, and prints them unless it is quiet.
void add_warnings(const Warnings& warnings, const JobContext& context, JobResult& result);

/// The same of facts that are no warnings.
void add_notes(const Warnings& notes, const JobContext& context, JobResult& result);

}  // namespace tetwarp::cli

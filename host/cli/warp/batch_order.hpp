/// @file batch_order.hpp
/// Files that the jobs of a batch read and write, and which job has to wait for which.
#pragma once
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "host/cli/job/output_writer.hpp"
#include "host/cli/job/warp_arguments.hpp"
#include "host/cli/warp/batch_file.hpp"

namespace tetwarp::cli {

/// Canonical paths of the files of a job.
struct JobFiles {
  std::set<std::string> reads;
  /// As planned from the files that are there: outputs, with --provenance the files beside them,
  /// and the report. Of a job that cannot be planned, or has an error, the output that it names.
  std::set<std::string> writes;
  bool is_planned = false;         ///< else it may write more: see `outputs`
  std::vector<SplitName> outputs;  ///< names that may have a step and an array before the extension
  /// That it may write to files of their own; none: not known.
  std::optional<std::set<std::string>> arrays;
};

/// Of each job. Where an earlier job writes what a job reads, the plan of that job is not trusted.
std::vector<JobFiles> files_of_jobs(const std::vector<BatchJob>& jobs);

/// Throws IoError when two jobs, or a job and the batch report, write the same file.
void check_collisions(const std::vector<BatchJob>& jobs,
                      const std::vector<JobFiles>& files,
                      const WarpArguments& shared);

/// An earlier job that has to end before a job starts.
struct Wait {
  std::size_t job;
  std::string input;  ///< of the waiting job, which the earlier one writes; empty: it reads or
                      ///< writes what the waiting one overwrites
};

/// Of each job the earlier ones that share a file with it that one of the two writes, ascending: so
/// ordered, jobs beside each other write what they write one after the other.
std::vector<std::vector<Wait>> waits_of_jobs(const std::vector<JobFiles>& files);

}  // namespace tetwarp::cli

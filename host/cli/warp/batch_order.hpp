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

/// Canonical paths of the files of a job, as far as they are known before it runs.
struct JobFiles {
  std::set<std::string> reads;
  /// Outputs, files of --provenance beside them, and the report. Of a job that cannot be planned
  /// yet, since an input is missing or wrong, only the output that it names.
  std::set<std::string> writes;
  /// False: `writes` may lack files, which are called as one of `outputs` with the number of a step
  /// and the name of an array before its extension.
  bool is_planned = false;
  std::vector<SplitName> outputs;
  std::optional<std::set<std::string>> arrays;  ///< that may be in such names; nothing: any
};

/// Of each job. One that reads what an earlier job writes counts as not planned: the file that is
/// there now may be another one than it will read.
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

/// @returns of each job the earlier ones, ascending, that write a file which it reads or writes, or
///          read one which it writes. Jobs that wait for these may run beside each other: the files
///          at the end are those of one job after the other.
std::vector<std::vector<Wait>> waits_of_jobs(const std::vector<JobFiles>& files);

}  // namespace tetwarp::cli

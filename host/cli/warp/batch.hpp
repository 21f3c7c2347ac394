/// @file batch.hpp
/// `tetwarp warp --batch jobs.json`: {"jobs": [{"volume": ..., "mesh": ..., "output": ..., any long
/// option without its dashes}, ...]}.
#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "host/cli/warp/warp_arguments.hpp"

namespace tetwarp::cli {

/// One job of a batch file: its arguments, or an error.
struct BatchJob {
  std::vector<std::string>
      volumes;         ///< as located from the batch file; also of a job with an error
  std::string mesh;    ///< empty: the job names none
  std::string output;  ///< empty: the job names none
  WarpArguments arguments;
  std::string error;  ///< empty: the arguments are valid
};

/// Reads a batch file. Relative paths in it start at its folder.
/// @param defaults  options as given on the command line, for jobs that do not set them
/// @throws IoError  when the file is not JSON or holds no list of jobs; an error inside a job is
///                  stored in that job
std::vector<BatchJob> read_batch(const std::string& path, const CLI::App& defaults);

/// Runs the jobs one after the other; a job that fails is reported and the next one runs. Writes
/// the report of the batch after each job. Throws IoError before anything is written when the file
/// cannot be read or two jobs write one file.
/// @param shared    arguments of the command line
/// @param defaults  the options of the command line as CLI11 parsed them
/// @returns exit code: 0, 1 when a job failed, 130 when interrupted
int run_batch(const WarpArguments& shared, const CLI::App& defaults);

}  // namespace tetwarp::cli

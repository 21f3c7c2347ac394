/// @file batch.hpp
/// `tetwarp warp --batch jobs.json`: {"jobs": [{"volume": ..., "mesh": ..., "output": ..., any long
/// option without its dashes}, ...]}.
#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "host/cli/warp_arguments.hpp"

namespace tetwarp::cli {

/// One job of a batch file: arguments, or why there are none.
struct BatchJob {
  WarpArguments arguments;
  std::string error;  ///< empty when the job was understood
};

/// Reads a batch file. Relative paths in it start at its folder.
/// @param defaults  options as given on the command line, for jobs that do not set them
/// @throws IoError  when the file is no JSON or holds no list of jobs; an error inside a job stays
/// there
std::vector<BatchJob> read_batch(const std::string& path, const CLI::App& defaults);

/// Runs every job that can run, reports the others, writes the report. Throws IoError before
/// anything is written when the file cannot be read or two jobs write one file.
/// @param shared    what was said on the command line
/// @param defaults  the same, as parsed words
/// @returns exit code: 0, 1 when a job failed, 130 when interrupted
int run_batch(const WarpArguments& shared, const CLI::App& defaults);

}  // namespace tetwarp::cli

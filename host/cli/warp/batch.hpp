/// @file batch.hpp
/// `tetwarp warp --batch jobs.json`: several warps in one run.
#pragma once
#include <CLI/CLI.hpp>

#include "host/cli/job/warp_arguments.hpp"

namespace tetwarp::cli {

/// Runs the jobs one after the other; a job that fails is reported and the next one runs. Writes
/// the report of the batch after each job. Throws IoError before anything is written when the file
/// cannot be read or two jobs write one file.
/// @param shared    arguments of the command line
/// @param defaults  the options of the command line as CLI11 parsed them
/// @returns exit code: 0, 1 when a job failed, 130 when interrupted
int run_batch(const WarpArguments& shared, const CLI::App& defaults);

}  // namespace tetwarp::cli

/// @file transform_job.hpp
/// `tetwarp warp` by a displacement field or an affine transform instead of a mesh.
#pragma once
#include <CLI/CLI.hpp>

#include "host/cli/job/warp_arguments.hpp"

namespace tetwarp::cli {

/// True when the last file is a transform.
bool names_transform(const WarpArguments& arguments);

/// Resamples a volume, all steps of a series, in memory.
/// @param command  the parsed options: those that need a mesh are refused
/// Throws std::invalid_argument, IoError, Cancelled.
void run_transform_job(const WarpArguments& arguments, const CLI::App& command);

}  // namespace tetwarp::cli

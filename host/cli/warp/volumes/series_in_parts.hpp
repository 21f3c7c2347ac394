/// @file series_in_parts.hpp
/// A series in one file that can be resumed.
#pragma once
#include "host/cli/common/progress_bar.hpp"
#include "host/cli/common/ranks.hpp"
#include "host/cli/job/fingerprint.hpp"
#include "host/cli/job/job_result.hpp"
#include "host/cli/warp/volumes/volume_task.hpp"

namespace tetwarp::cli {

/// Writes each step to a file of its own and then joins these files. A run that is ended early
/// leaves them for the next one, which keeps those that are complete and up to date.
/// @param fingerprint  of the series
/// @param ranks        one process
void write_series_in_parts(const VolumeTask& task,
                           const Fingerprint& fingerprint,
                           Ranks& ranks,
                           ProgressBar& bar,
                           JobResult& result);

}  // namespace tetwarp::cli

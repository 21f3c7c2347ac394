/// @file array_checks.hpp
/// The arrays of a volume to warp, and checks of them against the arguments of a warp.
#pragma once
#include <string>
#include <vector>

#include <tetwarp/io.hpp>

#include "host/cli/job/warp_arguments.hpp"

namespace tetwarp::cli {

/// The arrays to warp: those of --array, else all except extra outputs of an earlier warp. Throws
/// IoError about `path` when there is none.
std::vector<ArrayHeader> choose_arrays(const VolumeHeader& header,
                                       const WarpArguments& arguments,
                                       const std::string& path);

/// Checks the arrays of a volume file: --vectors and --tensors name some of them, their types fit
/// the options, their names are not those of extra outputs, and no fact is left out without which
/// vectors and tensors are something else. Throws IoError.
void check_arrays(const std::string& path,
                  const VolumeHeader& header,
                  const std::vector<ArrayHeader>& arrays,
                  const WarpArguments& arguments);

}  // namespace tetwarp::cli

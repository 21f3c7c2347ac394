/// @file array_checks.hpp
/// Checks of the arrays of a volume against the arguments of a warp.
#pragma once
#include <string>
#include <vector>

#include <tetwarp/io.hpp>

#include "host/cli/job/warp_arguments.hpp"

namespace tetwarp::cli {

/// Checks the arrays of a volume file: --vectors and --tensors name some of them, their types fit
/// the options, and their names are not those of extra outputs. Throws IoError.
void check_arrays(const std::string& path,
                  const Grid& grid,
                  const std::vector<ArrayHeader>& arrays,
                  const WarpArguments& arguments);

}  // namespace tetwarp::cli

/// @file array_checks.hpp
/// Whether arrays can be what the arguments say they are.
#pragma once
#include <string>
#include <vector>

#include <tetwarp/io.hpp>

#include "host/cli/warp_arguments.hpp"

namespace tetwarp::cli {

/// Vectors and tensors are among the arrays, have their components, and what is to be computed of
/// an array can be. Throws IoError.
void check_quantities(const std::string& path,
                      const std::vector<ArrayHeader>& arrays,
                      const WarpArguments& arguments);

}  // namespace tetwarp::cli

/// @file extra_outputs.hpp
/// The choice of `tetwarp warp --outputs`.
#pragma once
#include <cstddef>
#include <set>

#include "host/base/extra_outputs.hpp"

namespace tetwarp::cli {

/// Arrays to write in addition to the warped ones, as indices into the table `extra_outputs`.
using ExtraChoice = std::set<std::size_t>;

}  // namespace tetwarp::cli

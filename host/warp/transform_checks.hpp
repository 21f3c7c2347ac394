/// @file transform_checks.hpp
/// Whether options that give voxels more than plain samples go with sources and with each other.
#pragma once
#include <span>

#include <tetwarp/warp.hpp>

namespace tetwarp {

/// Throws std::invalid_argument, naming the option and what would do.
void check_transforms(std::span<const VolumeView> sources, const WarpOptions& options);

}  // namespace tetwarp

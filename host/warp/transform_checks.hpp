/// @file transform_checks.hpp
/// Checks of the options that change samples: antialias, intensity and quantities.
#pragma once
#include <span>

#include <tetwarp/warp.hpp>

namespace tetwarp {

/// @throws std::invalid_argument when these options do not fit the sources or each other, naming
/// the
///                               option and an alternative
void check_transforms(std::span<const VolumeView> sources, const WarpOptions& options);

}  // namespace tetwarp

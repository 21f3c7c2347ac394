/// @file transform_checks.hpp
/// Whether options fit the types of the sources and each other. Samples are not read.
#pragma once
#include <span>
#include <string>

#include <tetwarp/warp.hpp>

namespace tetwarp {

/// Checks that there are volumes of 1 to 9 components with samples, on one valid grid.
/// @param what_to_do  with volumes on different grids, e.g. "warp"
/// @throws std::invalid_argument that names the remedy
void check_sources(std::span<const VolumeView> sources, const std::string& what_to_do);

/// Checks the options for one source, whose data may be null.
/// @throws std::invalid_argument that names the option and a remedy
TETWARP_EXPORT void check_source_transform(const VolumeView& source,
                                           Quantity quantity,
                                           const WarpOptions& options);

/// Checks the options for all sources and with each other.
/// @throws std::invalid_argument as above
void check_transforms(std::span<const VolumeView> sources, const WarpOptions& options);

}  // namespace tetwarp

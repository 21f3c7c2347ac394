/// @file features.hpp
/// What is asked of a warp beyond samples of a volume, beside the plain warp.
#pragma once
#include "bench/warp_cases.hpp"

namespace tetwarp::bench {

/// Registers rows feature/NAME: steps of the torso workload, timed in turn with steps that are
/// plain but for the feature, on the same mesh, grid and number of components. Before, the same on
/// a volume of an eighth of the voxels is compared with the reference back end. Beside the counters
/// of a Timing:
///
///   plain           the plain step [ms]
///   cost            time / plain
///   ns_per_covered  [ns]
///   max_error       of the values, as a share of the image's range
void register_feature_rows(int threads);

}  // namespace tetwarp::bench

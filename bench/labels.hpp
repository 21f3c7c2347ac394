/// @file labels.hpp
/// Label images: how many voxels get a wrong one, and what a right one costs.
#pragma once
#include "bench/warp_cases.hpp"

namespace tetwarp::bench {

/// Registers rows labels/N: a source of N^3 labels, uint8, eight to a wave of a smooth image,
/// turned by 45 degrees about two axes, by each filter that makes no new labels. Beside the
/// counters of a Timing:
///
///   wrong_share     covered voxels whose label is not that of their place / covered voxels
///   ns_per_covered  time / covered voxels
void register_label_rows(Extent extent, int threads);

}  // namespace tetwarp::bench

/// @file overlap.hpp
/// What overlapping the steps of a series saves.
#pragma once
#include "bench/warp_cases.hpp"

namespace tetwarp::bench {

/// Registers rows overlap/WORKLOAD: whole steps to two page-locked buffers in turns, each begun
/// before the one before is finished. Timed in turn with the same steps one by one, whose output
/// must be the same, bit for bit. Times are per step. Beside the counters of a Timing:
///
///   apart       a step of the series taken one by one [ms]
///   cost_share  time / apart
///   max_error   of a step, as a share of the image's range
///
/// On processors nothing overlaps: there the row, of the full extent only, shows what the two
/// halves of a step cost.
void register_overlap_rows(Extent extent, int threads, bool with_cuda);

}  // namespace tetwarp::bench

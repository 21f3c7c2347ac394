/// @file series.hpp
/// Steps of a series in which only a part of the mesh moves.
#pragma once
#include "bench/warp_cases.hpp"

namespace tetwarp::bench {

/// Registers rows series/WORKLOAD/moved:P: the P percent of the nodes nearest to the middle move to
/// and fro, and each step updates the one before. Timed in turn with whole steps of the same
/// positions, whose output must be the same, bit for bit. Beside the counters of a Timing:
///
///   whole          a step that computes everything [ms]
///   cost_share     time / whole
///   tets_moved     share of the tetrahedra
///   cells_touched  share of the cells that are computed again
///   max_error      of the whole step, as a share of the image's range
void register_series_rows(Extent extent, int threads, bool with_cuda);

}  // namespace tetwarp::bench

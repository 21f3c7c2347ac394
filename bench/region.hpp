/// @file region.hpp
/// Steps that compute a part of the output grid.
#pragma once
#include "bench/warp_cases.hpp"

namespace tetwarp::bench {

/// Registers rows region/WORKLOAD: the middle half of each axis, an eighth of the voxels, timed in
/// turn with steps of the whole grid, whose part there must be the same, bit for bit. Beside the
/// counters of a Timing:
///
///   whole          a step of the whole grid [ms]
///   cost_share     time / whole
///   voxel_share    voxels of the region / voxels of the grid
///   covered_share  the same of the voxels in the mesh, which are nearly all of the work
void register_region_rows(int threads, bool with_cuda);

}  // namespace tetwarp::bench

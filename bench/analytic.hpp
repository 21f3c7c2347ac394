/// @file analytic.hpp
/// The error of a warp in its parts: where it samples, what interpolation makes of it, and which
/// voxels it covers.
#pragma once
#include "bench/warp_cases.hpp"

namespace tetwarp::bench {

/// Registers two kinds of rows.
///
/// analytic/N: a band-limited image (at most four waves per volume) of N^3 samples, turned by 45
/// degrees about two axes. The map and the image are formulas, so `max_error` and `rms_error`, over
/// all covered voxels, are those of interpolation: order 1 for nearest, 2 for linear. Those of
/// wider filters are taken half a volume wide in the middle: the image does not go on beyond the
/// rim as they have it.
///
/// position/WORKLOAD: sources that alternate between 0 and 1 along one axis. Interpolated linearly
/// they are triangle waves of slope 1, so an error of a value is one of the position, down to the
/// rounding of the value (1e-7 in float32): `position_max`, `position_rms` [voxel]. `holes`,
/// `painted`, `doubles` count wrong coverage; a row with any is refused.
void register_analytic_rows(Extent extent, int threads);

}  // namespace tetwarp::bench

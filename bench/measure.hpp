/// @file measure.hpp
/// Rows of Google Benchmark from cases: checked, timed, counted.
#pragma once
#include "bench/timed_row.hpp"
#include "bench/warp_cases.hpp"

namespace tetwarp::bench {

/// Registers a row. Run, it makes the input, checks a first result against the truth and refuses to
/// time a wrong one; then it times steps in turn with the sampling floor where the back end is cpu,
/// or, where something is switched off, in turn with steps that have it on.
/// The row's time is the median of at least nine repetitions. Its counters [ms where not said]:
///
///   low, high, min, kept, discarded, busy, contended       see Timing
///   construct, first_step    making a Warper (upload); the first step (first touch, buffers)
///   mean, upload, setup, mask, cull, raster, download      mean of all steps, and of their stages
///   kernel                   the step without upload and download
///   floor, floor_ratio       the sampling floor, and time / floor
///   copy_ratio               time / (bytes in and out at copy bandwidth)
///   kernel_copies            on cuda: kernel with upload and download
///   floor_copies             on cuda: the floor with its output brought home; there both ratios
///                            are those of `kernel`, and the row's label names the floor's layout
///   with, saved              the step with everything on; 1 - with / time
///   ns_per_covered, ns_per_voxel [ns]
///   max_error, rms_error     of the values, as a share of the image's range
///   compared, holes, painted, doubles                      see Accuracy
///   components, tets, voxels, covered, tests_per_covered, exact_tests, copied [voxels]
///   rejected_share, accepted_share [of pairs], constant_share [of cells]
void register_row(const WarpCase& row);

}  // namespace tetwarp::bench

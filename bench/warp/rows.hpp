/// @file rows.hpp
/// All rows of tetwarp_bench: what each measures, and its counters.
///
/// Every row makes its input, checks a result and is refused if that is wrong, then times the
/// median of at least nine repetitions, in turn with the job that it is compared to. All rows have
/// the counters of a Timing (low, high, min, kept, discarded, busy, contended); times are in ms,
/// errors of values are shares of the image's range, "plain" and "whole" are times of the other
/// job.
#pragma once
#include "bench/measure/row.hpp"
#include "bench/warp/step_cases.hpp"

namespace tetwarp::bench {

/// Steps of all workloads, filters, pixel types and thread counts (step_cases()). On cpu in turn
/// with the sampling floor; with a switch off, in turn with the same step with all switches on.
/// without:two_corners is the paper's method: cells are rejected and accepted by masks of their
/// eight corners.
///
///   construct, first_step    making a Warper (upload); the first step (first touch, buffers)
///   mean, upload, setup, mask, cull, raster, download      mean of all steps, and of their stages
///   kernel                   the step without upload and download
///   floor, floor_ratio       the sampling floor, and time / floor
///   copy_ratio               time / (bytes read and written at copy bandwidth)
///   kernel_copies            on cuda: kernel with upload and download
///   floor_copies             on cuda: the floor with the download of its output; there both ratios
///                            are those of `kernel`, and the row's label names the floor's layout
///   with, saved              the step with everything on; 1 - with / time
///   ns_per_covered, ns_per_voxel [ns]
///   max_error, rms_error
///   compared, holes, painted, doubles                      see Accuracy
///   components, tets, voxels, covered, tests_per_covered, exact_tests, copied [voxels]
///   rejected_share, accepted_share [of pairs], constant_share [of cells]
void add_step_rows(const Selection& selection);

/// series/WORKLOAD/moved:P: the P percent of the nodes nearest to the middle move between two
/// poses, and each step updates the one before. In turn with whole steps of the same positions,
/// whose output must have the same bits.
///
///   whole, cost_share  a step that computes everything; time / whole
///   tets_moved         share of the tetrahedra
///   cells_touched      share of the cells that are computed again
///   max_error          of the whole step
void add_series_rows(const Selection& selection);

/// overlap/WORKLOAD: steps to two page-locked buffers alternately, each begun before the one before
/// is finished. In turn with the same steps one by one, whose output must have the same bits. Times
/// are per step. On a processor nothing overlaps: there the row, of the full extent only, shows
/// what splitting a step into begin and finish costs.
///
///   apart, cost_share  a step of the series taken one by one; time / apart
///   max_error          of a step
void add_overlap_rows(const Selection& selection);

/// resident/WORKLOAD/.../cuda: wall time of steps whose source, positions and output stay in memory
/// of the device, from the call to its return, which waits for the device. Two poses in turn; the
/// output must be that of back end cpu but for fused multiply-add.
///
///   kernel                    sum of the stages of one step
///   floor, floor_ratio        the device's sampling floor, its layout in the label; time / floor
///   copy_ratio                time / (output read and written at the device's copy bandwidth)
void add_resident_rows(const Selection& selection);

/// copies/WORKLOAD/linear/float32/cuda: steps into pageable memory of the host, in turn with steps
/// into page-locked memory and into memory of the device; all outputs must have the same bits.
///
///   locked, resident    the steps into page-locked memory; into memory of the device
///   rate, locked_rate   bytes of the output / (time - resident), (locked - resident) [GB/s]
///   rate_share          rate / locked_rate
///   construct           making the first Warper, whose source is in pageable memory
///   construct_locked    making a later one with the source page-locked
///   first_step          into memory that nothing has touched
///   lock                page-locking such memory
///
/// staging/to_host_MIB/24x2/cuda/threads:T, to_device_MIB: one copy of pageable memory through a
/// StagingRing of 24 slots of 2 MiB, in turn with copies by the runtime and of page-locked memory.
/// to_host_untouched_MIB: into memory that nothing has touched.
///
///   rate, runtime_rate, locked_rate [GB/s]
///   rate_share          rate / locked_rate
///   lock                page-locking and unlocking the memory
void add_copy_rows(const Selection& selection);

/// paper/WORKLOAD/.../PLACE, with /without:cells: steps by the method of Gascon et al. 2013, on a
/// device in its memory. A row is refused if more than one voxel in 200 is a hole or painted, or a
/// sample is off by 0.02: its float32 tests miss voxels and take maps of neighbors.
///
///   tested, pass_share  voxels tested against a tetrahedron; those within it / tested (cpu)
///   culled_share        cells that masks reject / cells of all bounding boxes (cpu, with cells)
///   compared, holes, painted, max_error, voxels, tets
void add_paper_rows(const Selection& selection);

/// region/WORKLOAD: steps that compute the middle half of each axis, an eighth of the voxels. In
/// turn with steps of the whole grid, which must have the same bits there.
///
///   whole, cost_share  a step of the whole grid; time / whole
///   voxel_share        voxels of the region / voxels of the grid
///   covered_share      the same of the voxels in the mesh, which take nearly all of the time
void add_region_rows(const Selection& selection);

/// chunks/WORKLOAD: writing a step's output to a temporary file without its chunks of background.
/// In turn with writing all chunks; both files must hold the step's samples.
///
///   whole, cost_share           writing every chunk; time / whole
///   background_share            chunks of background / chunks
///   megabytes, whole_megabytes  of the file; of the file with every chunk
void add_chunk_rows(const Selection& selection);

/// analytic/N: a band-limited image (at most four waves per volume) of N^3 samples, turned by 45
/// degrees about two axes. Map and image are formulas, so the errors are those of interpolation:
/// order 1 for nearest, 2 for linear. Errors of wider filters are taken over the middle half of
/// each axis, because those filters continue the image beyond the rim in another way.
///
///   n, max_error, rms_error, ns_per_covered [ns]
void add_analytic_rows(const Selection& selection);

/// labels/N: N^3 labels, uint8, eight levels of a smooth image, turned by 45 degrees about two
/// axes, by each filter that makes no new labels.
///
///   wrong_share     covered voxels whose label is not that of their position / covered voxels
///   ns_per_covered  [ns]
void add_label_rows(const Selection& selection);

/// feature/NAME: steps of the torso workload with an option that does more than sample. In turn
/// with plain steps on the same mesh, grid and components. Before, the same on an eighth of the
/// voxels is compared with the reference back end.
///
///   plain, cost     the plain step; time / plain
///   ns_per_covered  [ns]
///   max_error
void add_feature_rows(const Selection& selection);

/// fields/WORKLOAD/FIELD: steps that also write a field of the deformation. In turn with steps
/// without it.
///
///   plain                 the step without the field
///   field_ns_per_covered  what the field adds [ns]
void add_field_rows(const Selection& selection);

/// resample/N/LINKS: resample() of N^3 samples by a displacement field, on the grid of the output
/// or another one, or by several transforms, in turn with an affine map. Random samples; some are
/// compared with linear ones in float64. Processor time of all threads together, least, per voxel.
///
///   processor_ns, affine_ns  by the transforms, by the affine map [ns]
///   read_ns                  bytes of the fields at copy bandwidth, one thread [ns]
///   bound_share              processor_ns / (1.5 affine_ns + read_ns)
///   max_error
void add_transform_rows(const Selection& selection);

/// points/WORKLOAD/COUNT: map_points() of points in no order, from rest to the deformed positions
/// and back, where each must be again. A call makes the search for owners, too.
///
///   points_per_second  of moves, of which each repetition makes two per point
///   processor_ns       processor time of a move, of all threads together, least [ns]
///   max_error          largest distance from where a point began [world]
void add_point_rows(const Selection& selection);

}  // namespace tetwarp::bench

/// @file rows.hpp
/// Rows of tetwarp_bench_collide: a pile of 20 balls that just touch and move by 0.1 mm. The pairs
/// of boxes are compared with those of the sort-and-sweep.
///
/// detect/triangles:N/self:S/threads:T  time of Detector::detect() of a new step. With self 1 each
///     body touches itself: all pairs of triangles count. Counters: broad and narrow, times up to
///     the pairs of triangles and of the rest [ms]; per triangle: entries in grids, box_tests,
///     box_pairs; pairs: of features, tested for contact
/// again/...                            detect() of the same step, which keeps the pairs
/// sweep/...                            boxes sorted along x and swept, one thread
#pragma once
#include <string>

#include "bench/measure/program.hpp"

namespace tetwarp::bench {

void add_collide_rows(Extent extent);

/// Writes FOLDER/pile_N.bin for each size: int64 numbers of vertices, edges and triangles; float64
/// starts and ends of vertices; int32 edges and triangles.
/// @returns exit code: 1 if a file cannot be written
int export_piles(const std::string& folder, Extent extent);

}  // namespace tetwarp::bench

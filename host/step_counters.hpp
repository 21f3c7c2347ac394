/// @file step_counters.hpp
/// What the stages count on the device, and the step's report made of it.
#pragma once
#include <cstdint>

#include <tetwarp/report.hpp>

#include "host/stage_times.hpp"
#include "kernels/cell_raster.hpp"
#include "kernels/tet_setup.hpp"
#include "kernels/view.hpp"

namespace tetwarp {

/// Counters of one step, zeroed at its start.
struct StepCounters {
  std::int64_t classes[tet_class_count];
  std::int64_t pairs;
  std::int64_t accepted;
  std::int64_t folded;
  RasterCounts raster;
};

/// The report of a step: stage times by label, counters, sizes.
inline StepReport make_step_report(const StepCounters& counters,
                                   const StageTimes& times,
                                   const OutputFrame& frame,
                                   std::int64_t tet_count,
                                   std::int64_t candidate_pairs) {
  StepReport report;
  report.timings.upload = times.of("warp/upload");
  report.timings.setup = times.of("warp/setup");
  report.timings.mask = times.of("warp/mask");
  report.timings.cull = times.of("warp/cull");
  report.timings.raster = times.of("warp/raster") + times.of("warp/fold");
  report.timings.download = times.of("warp/download");
  Counts& counts = report.counts;
  counts.voxels = frame.voxel_count();
  counts.covered = counters.raster.covered;
  counts.outside = counts.voxels - counts.covered;
  counts.tetrahedra = tet_count;
  counts.inverted = counters.classes[static_cast<int>(TetClass::inverted)];
  counts.flat = counters.classes[static_cast<int>(TetClass::flat)];
  counts.folded = counters.folded;
  counts.cells = frame.cell_count();
  counts.candidate_pairs = candidate_pairs;
  counts.pairs_rejected = candidate_pairs - counters.pairs;
  counts.pairs_accepted = counters.accepted;
  counts.pairs_partial = counters.pairs - counters.accepted;
  counts.inside_tests = counters.raster.inside_tests;
  counts.exact_tests = counters.raster.exact_tests;
  counts.voxels_copied = counters.raster.copied;
  return report;
}

}  // namespace tetwarp

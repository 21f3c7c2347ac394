/// @file step_counters.hpp
/// What the stages count on the device, and the step's report made of it.
#pragma once
#include <cstdint>

#include <tetwarp/report.hpp>

#include "kernels/base/stage_times.hpp"
#include "kernels/base/view.hpp"
#include "kernels/warp/cell_raster.hpp"
#include "kernels/warp/tet_setup.hpp"

namespace tetwarp {

/// Counters that describe the mesh as it stands: a step that updates the one before keeps them up
/// to date, any other starts them anew.
struct MeshCounters {
  std::int64_t classes[tet_class_count];
  std::int64_t folded;
  std::int64_t averaged;  ///< tetrahedra whose voxels are means of samples
};

/// Counters of the work of one step, zeroed at its start.
struct WorkCounters {
  std::int64_t moved;         ///< tetrahedra, of an update
  std::int64_t corners;       ///< that the tetrahedra to cull have
  std::int64_t candidates;    ///< that they have
  std::int64_t pairs;         ///< that were not rejected
  std::int64_t merged_pairs;  ///< all pairs after an update
  std::int64_t accepted;
  std::int64_t touched_cells;
  std::int64_t constant_cells;
  std::int64_t covered;  ///< of the whole output, kept cells included
  RasterCounts raster;
};

struct StepCounters {
  MeshCounters mesh;
  WorkCounters work;
};

/// Brings the ends of sums to where the other counters are, so that the host reads once. One index.
struct TotalsBody {
  View<const std::int64_t> moved_offsets;  ///< size 0: not an update
  View<const std::int64_t> corner_offsets;
  View<const std::int64_t> pair_offsets;
  View<WorkCounters> work;

  TETWARP_HD void operator()(std::int64_t) const {
    if (moved_offsets.size > 0) work[0].moved = moved_offsets[moved_offsets.size - 1];
    work[0].corners = corner_offsets[corner_offsets.size - 1];
    work[0].candidates = pair_offsets[pair_offsets.size - 1];
  }
};

/// How much of the mesh and of the output a step had to do with.
struct StepSizes {
  std::int64_t tets;
  std::int64_t tets_unchanged;
  std::int64_t cells_unchanged;
  std::int64_t candidate_pairs;
};

/// Adds stage times by label.
inline void add_stages(const StageTimes& times, Timings& timings) {
  timings.upload += times.of("warp/upload");
  timings.setup += times.of("warp/setup");
  timings.mask += times.of("warp/mask");
  timings.cull += times.of("warp/cull");
  timings.raster += times.of("warp/raster") + times.of("warp/fold");
  timings.fields += times.of("warp/fields");
  timings.download += times.of("warp/download");
}

/// The report of a step without its times: counters and sizes.
inline StepReport make_step_report(const StepCounters& counters,
                                   const OutputFrame& frame,
                                   const StepSizes& sizes) {
  StepReport report;
  Counts& counts = report.counts;
  const WorkCounters& work = counters.work;
  counts.voxels = frame.voxel_count();
  counts.covered = work.covered;
  counts.outside = counts.voxels - counts.covered;
  counts.tetrahedra = sizes.tets;
  counts.inverted = counters.mesh.classes[static_cast<int>(TetClass::inverted)];
  counts.flat = counters.mesh.classes[static_cast<int>(TetClass::flat)];
  counts.folded = counters.mesh.folded;
  counts.tets_averaged = counters.mesh.averaged;
  counts.cells = frame.cell_count();
  counts.candidate_pairs = sizes.candidate_pairs;
  counts.pairs_rejected = sizes.candidate_pairs - work.pairs;
  counts.pairs_accepted = work.accepted;
  counts.pairs_partial = work.pairs - work.accepted;
  counts.inside_tests = work.raster.inside_tests;
  counts.exact_tests = work.raster.exact_tests;
  counts.tets_unchanged = sizes.tets_unchanged;
  counts.cells_unchanged = sizes.cells_unchanged;
  counts.cells_constant = work.constant_cells;
  counts.voxels_copied = work.raster.copied;
  return report;
}

}  // namespace tetwarp

/// @file step_counters.hpp
/// The counters of a step in the executor's memory, and the report made from them.
#pragma once
#include <cstdint>

#include <tetwarp/report.hpp>

#include "kernels/base/stage_times.hpp"
#include "kernels/base/view.hpp"
#include "kernels/warp/cell_raster.hpp"
#include "kernels/warp/tet_setup.hpp"

namespace tetwarp {

/// Counters of the current mesh. An update adjusts those of the previous step, any other step
/// starts from zero.
struct MeshCounters {
  std::int64_t classes[tet_class_count];
  std::int64_t folded;
  std::int64_t averaged;  ///< tetrahedra whose voxels are means of samples
};

/// Counters of the work of one step, set to zero at its start.
struct WorkCounters {
  std::int64_t moved;           ///< tetrahedra that have moved; updates only
  std::int64_t corners;         ///< coarse corners of the tetrahedra to cull
  std::int64_t candidates;      ///< candidate pairs of these tetrahedra
  std::int64_t pairs;           ///< of the candidates, not rejected
  std::int64_t merged_pairs;    ///< all pairs after an update
  std::int64_t accepted;        ///< of `pairs`
  std::int64_t touched_cells;   ///< updates only
  std::int64_t constant_cells;  ///< cells that were filled
  std::int64_t covered;         ///< voxels of the whole output, including cells that were kept
  RasterCounts raster;
};

struct StepCounters {
  MeshCounters mesh;
  WorkCounters work;
};

/// Copies the totals of three scans to the counters, so that the host reads memory once. One index.
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

/// Numbers of a report that do not depend on the step's counters.
struct StepSizes {
  std::int64_t tets;
  std::int64_t tets_unchanged;
  std::int64_t cells_unchanged;
  std::int64_t candidate_pairs;
};

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

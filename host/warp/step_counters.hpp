/// @file step_counters.hpp
/// The counters of a step in the executor's memory, and the report made from them.
#pragma once
#include <cstddef>
#include <cstdint>

#include <tetwarp/report.hpp>

#include "kernels/base/stage_times.hpp"
#include "kernels/base/view.hpp"
#include "kernels/warp/cell_class.hpp"
#include "kernels/warp/tet_setup.hpp"

namespace tetwarp {

/// Counters of the current mesh. An update adjusts those of the previous step, any other step
/// starts from zero.
struct MeshCounters {
  std::int64_t classes[tet_class_count];
  std::int64_t folded;
  std::int64_t averaged;  ///< tetrahedra whose voxels are means of samples
};

/// Counters of the work of one step, set to zero at its start. From `moved` on they are sums of
/// SpreadCounts.
struct WorkCounters {
  std::int64_t candidates;      ///< candidate pairs of the tetrahedra to cull
  std::int64_t merged_pairs;    ///< all pairs of the step
  std::int64_t straightened;    ///< voxels whose curved map has no inverse
  std::int64_t moved;           ///< tetrahedra that have moved
  std::int64_t pairs;           ///< of the candidates, not rejected
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

/// Counters to which many threads add, each in several places; set to zero at a step's start.
struct SpreadCounts {
  static constexpr std::int64_t places = 64;

  std::int64_t moved[places], pairs[places], accepted[places], touched_cells[places],
      constant_cells[places], covered[places];
  RasterCounts raster[places];
};

/// The counters in an executor's memory, in the order in which a step clears them: all but `mesh`,
/// which updates adjust.
struct CounterMemory {
  MeshCounters mesh;
  WorkCounters work;
  SpreadCounts spread;
  CellListCounts lists;  ///< of the first source
};
constexpr std::int64_t counter_words = sizeof(StepCounters) / sizeof(std::int64_t);
constexpr std::int64_t kept_words = sizeof(MeshCounters) / sizeof(std::int64_t);
constexpr std::int64_t memory_words = sizeof(CounterMemory) / sizeof(std::int64_t);

/// Word k of the StepCounters that the counters in an executor's memory make.
TETWARP_HD std::int64_t counter_word(const CounterMemory& memory, std::int64_t k) {
  constexpr std::int64_t raster_words = sizeof(RasterCounts) / sizeof(std::int64_t);
  constexpr std::int64_t single_words = 6;
  constexpr std::int64_t first = counter_words - raster_words - single_words;
  std::int64_t sum = reinterpret_cast<const std::int64_t*>(&memory)[k];
  if (k < first) return sum;
  const bool is_single = k < first + single_words;
  const std::int64_t* const from =
      reinterpret_cast<const std::int64_t*>(&memory.spread) +
      (is_single ? (k - first) * SpreadCounts::places
                 : single_words * SpreadCounts::places + (k - first - single_words));
  const std::int64_t step = is_single ? 1 : raster_words;
#if defined(__CUDA_ARCH__)
#pragma unroll 32  // so many loads at a time
#endif
  for (std::int64_t p = 0; p < SpreadCounts::places; ++p) sum += from[p * step];
  return sum;
}

/// One index = one word of the result.
struct CounterTotalOp {
  const CounterMemory* memory;
  View<std::int64_t> totals;  ///< out, shape [counter_words]; may be page-locked memory of the host

  TETWARP_HD void operator()(std::int64_t k) const { totals[k] = counter_word(*memory, k); }
};

/// The same after a sum over all cells: one index = the covered voxels of covered_cells cells.
struct CoveredTotalOp {
  static constexpr std::int64_t covered_cells = 256;
  View<const std::uint16_t> cell_covered;
  CounterTotalOp total;

  TETWARP_HD std::int64_t operator()(std::int64_t part) const {
    const std::int64_t end = min_of((part + 1) * covered_cells, cell_covered.size);
    std::int64_t sum = 0;
    for (std::int64_t cell = part * covered_cells; cell < end; ++cell) sum += cell_covered[cell];
    return sum;
  }
  TETWARP_HD void finish(std::int64_t covered, int k) const {
    if (k >= counter_words) return;
    total(k);
    if (k == covered_word) total.totals[k] = covered;
  }
  static constexpr std::int64_t covered_word =
      static_cast<std::int64_t>(offsetof(StepCounters, work) + offsetof(WorkCounters, covered)) / 8;
};

/// Copies the totals of two scans to the counters, so that the host reads memory once. One index.
struct TotalsOp {
  View<const std::int64_t> moved_offsets;  ///< size 0: not an update
  View<const std::int64_t> pair_offsets;
  CounterMemory* counters;

  TETWARP_HD void operator()(std::int64_t) const {
    if (moved_offsets.size > 0) {
      counters->spread.moved[0] = moved_offsets[moved_offsets.size - 1];
    }
    counters->work.candidates = pair_offsets[pair_offsets.size - 1];
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
  counts.voxels_straightened = work.straightened;
  return report;
}

}  // namespace tetwarp

/// @file report.hpp
/// What a warp did: timings, counts, back end. Field names of the JSON are an interface.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/backend.hpp>
#include <tetwarp/export.hpp>

namespace tetwarp {

/// Seconds per stage. A stage that did not run is zero.
struct Timings {
  double read = 0;
  double upload = 0;
  double setup = 0;
  double mask = 0;
  double cull = 0;
  double raster = 0;
  double fields = 0;  ///< displacement, strain and the like, when asked for
  double download = 0;
  double write = 0;
  double total = 0;

  Timings& operator+=(const Timings& other);
};

/// What was done and what was skipped, summed over steps (per-step values in StepReport).
struct Counts {
  std::int64_t voxels = 0;  ///< output voxels = covered + outside
  std::int64_t covered = 0;
  std::int64_t outside = 0;
  std::int64_t tetrahedra = 0;
  std::int64_t inverted = 0;         ///< det(deformed) * det(rest) < 0; they map like others
  std::int64_t flat = 0;             ///< zero quantized volume; they own nothing
  std::int64_t folded = 0;           ///< voxels strictly inside two or more, when asked for
  std::int64_t cells = 0;            ///< 8x8x8-voxel cells of the output grid
  std::int64_t candidate_pairs = 0;  ///< (tetrahedron, cell) pairs = rejected + accepted + partial
  std::int64_t pairs_rejected = 0;
  std::int64_t pairs_accepted = 0;
  std::int64_t pairs_partial = 0;
  std::int64_t inside_tests = 0;     ///< (voxel, tetrahedron) tests against four planes
  std::int64_t exact_tests = 0;      ///< of these, decided in exact integers
  std::int64_t steps_unchanged = 0;  ///< steps equal to the one before, not computed again
  std::int64_t tets_unchanged = 0;   ///< tetrahedra that have not moved: their setup was kept
  std::int64_t cells_unchanged = 0;  ///< cells that no moved tetrahedron touches: left as they were
  std::int64_t cells_constant = 0;   ///< cells of one value: filled, not sampled (first source)
  std::int64_t voxels_copied = 0;    ///< voxels moved by whole voxels: copied, not interpolated
  std::int64_t chunks_background = 0;  ///< chunks of files that hold only background: not stored
  std::int64_t tets_averaged = 0;      ///< tetrahedra whose voxels are means of samples (antialias)
  std::int64_t blocks = 0;  ///< of the output, computed on their own; none where memory held all
  std::int64_t bytes_read = 0;
  std::int64_t bytes_written = 0;

  Counts& operator+=(const Counts& other);
};

/// Integrals over the world, of every component of the first source, then of the next, as far as
/// there is room. Only where intensities are densities or conserved, and of whole sources.
struct Totals {
  static constexpr std::size_t most = 18;
  std::size_t count = 0;
  /// Of the source, constant in the box of each voxel, over all tetrahedra at rest.
  std::array<double, most> before = {};
  std::array<double, most> after = {};  ///< of the whole output, background and all
};

/// One step of a series.
struct StepReport {
  std::int64_t step = 0;
  Timings timings;
  Counts counts;
  Totals totals;
};

/// A whole run.
struct Report {
  std::string version;
  Backend backend = Backend::cpu;
  std::string backend_reason;  ///< why this back end, in one sentence
  std::string device;
  int threads = 1;
  double position_quantum = 0;  ///< node positions are rounded to multiples of this [voxel]
  Timings timings;              ///< sums over steps
  Counts counts;                ///< sums over steps
  std::vector<StepReport> steps;
};

/// The report as a JSON object.
TETWARP_EXPORT std::string to_json(const Report& report);

}  // namespace tetwarp

/// @file report.hpp
/// What a warp did: timings, counts, back end. The names in the JSON are those of the members; they
/// do not change between versions.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/backend.hpp>
#include <tetwarp/export.hpp>

namespace tetwarp {

/// Seconds per stage; zero: it did not run, or was not measured (WarpOptions::stage_times).
struct TETWARP_EXPORT Timings {
  double read = 0;      ///< of files; 0 for a Warper
  double upload = 0;    ///< host to device: sources once, node positions in each step
  double setup = 0;     ///< planes and maps of the tetrahedra
  double mask = 0;      ///< corners of cells against the planes of tetrahedra; 0 without
                        ///< SkipOptions::grid_point_masks
  double cull = 0;      ///< pairs of tetrahedron and cell: rejected, accepted or partial; sorted
  double raster = 0;    ///< owners and samples of all voxels
  double fields = 0;    ///< arrays of FieldTarget
  double download = 0;  ///< device to host
  double write = 0;     ///< of files; 0 for a Warper
  double total = 0;     ///< of the whole step; steps in flight at the same time overlap

  Timings& operator+=(const Timings& other);
};

/// Amounts of work, done and skipped: of one step in StepReport, summed over steps in Report.
struct TETWARP_EXPORT Counts {
  std::int64_t voxels = 0;           ///< of the output = covered + outside
  std::int64_t covered = 0;          ///< voxels that some tetrahedron owns
  std::int64_t outside = 0;          ///< voxels that no tetrahedron covers
  std::int64_t tetrahedra = 0;       ///< of the mesh; each hexahedron counts as six
  std::int64_t inverted = 0;         ///< det(deformed) * det(rest) < 0; they map like others
  std::int64_t flat = 0;             ///< zero volume after rounding of nodes; they own no voxel
  std::int64_t folded = 0;           ///< voxels strictly inside two or more tetrahedra;
                                     ///< 0 without WarpOptions::count_folded
  std::int64_t cells = 0;            ///< 8x8x8-voxel cells of the output grid
  std::int64_t candidate_pairs = 0;  ///< (tetrahedron, cell) pairs = rejected + accepted + partial
  std::int64_t pairs_rejected = 0;   ///< no voxel of the cell is inside the tetrahedron
  std::int64_t pairs_accepted = 0;   ///< all voxels of the cell are inside the tetrahedron
  std::int64_t pairs_partial = 0;    ///< voxels of the cell are tested one by one
  std::int64_t inside_tests = 0;     ///< (voxel, tetrahedron) tests against four planes
  std::int64_t exact_tests = 0;      ///< of these, decided in exact integers
  std::int64_t steps_unchanged = 0;  ///< steps equal to the one before, not computed again
  std::int64_t tets_unchanged = 0;   ///< tetrahedra that have not moved: their setup was kept
  std::int64_t cells_unchanged = 0;  ///< cells without a moved tetrahedron: not written again
  std::int64_t cells_constant = 0;   ///< cells of one value: filled, not sampled (first source)
  std::int64_t voxels_copied = 0;    ///< voxels moved by whole voxels: copied, not interpolated
  std::int64_t voxels_straightened = 0;  ///< voxels of tetrahedra of ten nodes that are mapped by
                                         ///< the straight one, see CurvedMesh
  std::int64_t chunks_background = 0;    ///< file chunks that hold only background: not stored
  std::int64_t tets_averaged = 0;   ///< tetrahedra whose voxels are means of samples (antialias)
  std::int64_t values_clipped = 0;  ///< integers of Intensity::conservative beyond the limits of
                                    ///< the pixel type, stored as the limit
  std::int64_t blocks = 0;      ///< parts of the output computed one by one; 0: the whole at once
  std::int64_t bytes_read = 0;  ///< from files
  std::int64_t bytes_written = 0;  ///< to files

  Counts& operator+=(const Counts& other);
};

/// Integrals over the world: one entry per component of the first source, then of the next. Empty
/// for Intensity::value and for warps of a SourceWindow.
struct Totals {
  /// Of the source, constant in the box of each voxel, over all tetrahedra at rest.
  std::vector<double> before = {};
  std::vector<double> after = {};  ///< of the whole output, including the background
  /// Of Intensity::conservative, included in `after`: what rounding to integers has added, 0 for
  /// floating point. Without bias; the standard deviation is at most 0.5 sqrt(n) times the volume
  /// of a voxel, n the number of voxels whose values are not whole.
  std::vector<double> rounding = {};
  /// Of Intensity::conservative, included in `after`: what clipping integers to the limits of the
  /// pixel type has added, 0 for floating point.
  std::vector<double> clipping = {};

  /// rounding + clipping of a component relative to the total without them; infinite if that is
  /// zero, 0 if nothing has changed.
  TETWARP_EXPORT double relative_change(std::size_t component) const;
};

/// One step of a series.
struct StepReport {
  std::int64_t step = 0;  ///< number of the step, from 0; in reports of the command its number in
                          ///< the mesh file
  Timings timings;
  Counts counts;
  Totals totals;
};

/// All steps of a Warper, or of a job of the command.
struct Report {
  std::string version;
  Backend backend = Backend::cpu;
  std::string backend_reason;   ///< why this back end, in one sentence
  std::string device;           ///< name of the device or processor
  int threads = 1;              ///< host threads that compute
  double position_quantum = 0;  ///< node positions are rounded to multiples of this [voxel]
  Timings timings;              ///< sums over steps
  Counts counts;                ///< sums over steps
  std::vector<StepReport> steps;
};

/// The report as a JSON object.
TETWARP_EXPORT std::string to_json(const Report& report);

}  // namespace tetwarp

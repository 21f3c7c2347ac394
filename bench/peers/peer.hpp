/// @file peer.hpp
/// Other ways to warp a volume, timed beside tetwarp on the same input: float32, linear.
#pragma once
#include <array>
#include <cstdint>
#include <functional>

#include "bench/measure/floors.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::bench {

/// Input of every program. Grids have unit spacing, the source grid its origin at zero.
struct PeerInput {
  const scenes::Scene& scene;
  const float* source;  ///< [k][j][i], followed by readable bytes
  float* output;        ///< to be written; zero where no tetrahedron covers a voxel
  int threads;
  /// Source position minus output position, both in voxels of their grids, three per output voxel;
  /// 1e6 where no tetrahedron covers the voxel. Only sampling programs read it.
  const float* displacement;

  std::array<int, 3> source_dims() const { return dims_of(scene.source_grid); }
  std::array<int, 3> output_dims() const { return dims_of(scene.output_grid); }
  std::size_t tet_count() const { return scene.mesh.tets.size(); }

 private:
  static std::array<int, 3> dims_of(const Grid& grid) {
    return {static_cast<int>(grid.dims[0]), static_cast<int>(grid.dims[1]),
            static_cast<int>(grid.dims[2])};
  }
};

/// A tetrahedron in voxels of the output (deformed) and of the source (rest).
struct PeerTet {
  double deformed[4][3];
  double rest[4][3];
  int low[3], high[3];   ///< voxels of its bounding box in the output, both included
  double weights[3][3];  ///< barycentric[n + 1] = weights[n] . (x - deformed[0])
};
PeerTet peer_tet(const scenes::Scene& scene, std::size_t tet);

/// Sets all of the output to zero, on all threads.
void fill_background(const PeerInput& input);

/// One whole step: called repeatedly, it writes the whole output each time.
using PeerStep = std::function<void()>;

/// The sampling floor in AVX-512 instructions: the job's map for every voxel, no tetrahedra.
void sample_affine_avx512(const AffineJob& job, RowOrder order, int threads);

/// Scanlines in AVX-512 instructions: for each tetrahedron and row the covered interval from its
/// four face planes, half open, in double; then 16 voxels at a time.
PeerStep scanline_probe(const PeerInput& input);

/// What a step of the paper's method did.
struct PaperCounts {
  std::int64_t cells = 0;   ///< of 8 x 8 x 8 voxels, of all bounding boxes
  std::int64_t drawn = 0;   ///< those that were not rejected; without cells: bounding boxes
  std::int64_t tested = 0;  ///< voxels, each against the tetrahedron of its cell or box
  std::int64_t passed = 0;  ///< of these, those within the tetrahedron
};

/// Gascon et al. 2013, algorithm 1, in float32: for each tetrahedron all voxels of its bounding
/// box; with_cells: only those of 8 x 8 x 8 cells that its corner masks do not reject.
/// @param counts  out, of the last step; may be null
PeerStep paper_method(const PeerInput& input, bool with_cells, PaperCounts* counts = nullptr);

/// VTK: vtkStaticCellLocator::FindCell for every voxel, then vtkImageInterpolator. Building the
/// grid and the locator is part of the step, since the mesh moves.
PeerStep vtk_locator(const PeerInput& input);

/// ITK: WarpImageFilter with the dense displacement field given, so only the sampling half of the
/// job.
PeerStep itk_warp(const PeerInput& input);

}  // namespace tetwarp::bench

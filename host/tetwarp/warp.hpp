/// @file warp.hpp
/// Deform volumes by a mesh: every output voxel gets the sample of the source at the rest position
/// of the material point that the deformed mesh has moved to the voxel's center.
///
/// Source: J. Gascon et al., "Fast Deformation of Volume Data Using Tetrahedral Mesh
/// Rasterization", SCA 2013.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <tetwarp/backend.hpp>
#include <tetwarp/choices.hpp>
#include <tetwarp/curved_mesh.hpp>
#include <tetwarp/export.hpp>
#include <tetwarp/mesh.hpp>
#include <tetwarp/report.hpp>
#include <tetwarp/volume.hpp>

namespace tetwarp {

/// Interpolated values beyond the range of the samples (cubic, bspline and lanczos, at edges).
enum class Overshoot {
  keep,  ///< written as they are
  clamp  ///< limited to the least and largest sample of the source, component by component
};

/// Which label a voxel gets with Filter::labels.
enum class LabelRule {
  linear,  ///< at the voxel's center the label with the largest sum of linear weights
  /// The label with the largest volume in the voxel's box, exactly: the source's voxels are boxes
  /// that the tetrahedra move. What is not covered, or comes from beyond the source, counts for the
  /// background. Shares of a box that differ by at most 2^-16 are equal; of equal ones the lowest
  /// label wins. For outputs of larger voxels and meshes that shrink; at most 32 bits
  volume,
  /// At the voxel's center the label with the largest sum of Gaussian weights, as
  /// LabelImageGaussianInterpolateImageFunction of ITK; see LabelGaussian. At most 32 bits
  gaussian
};

/// The Gaussian of LabelRule::gaussian. The weight of a source voxel is the Gaussian's integral
/// over its box; sums that differ by at most 2^-40 of the whole integral are equal, and of equal
/// ones the lowest label wins. The defaults are those of ITK and SimpleITK.
struct LabelGaussian {
  double sigma = 1;   ///< standard deviation, above 0 [source voxel]
  double cutoff = 1;  ///< source voxels within it have weights (alpha of ITK), above 0 [sigma];
                      ///< at most 8 source voxels
};

/// The physical meaning of samples, which determines how they change where volume changes.
enum class Intensity {
  value,    ///< a property of the material point: unchanged
  density,  ///< an amount per volume: divided by |det F|, after vectors and tensors are reoriented.
            ///< The integral is preserved up to the error of sampling
  /// An amount per volume, averaged exactly. The source counts as constant in the box of each of
  /// its voxels; an output voxel is the sum of the amounts that all tetrahedra move into its box,
  /// over the box's volume. `filter` is not used. The integral is preserved up to rounding;
  /// integers are rounded up with the probability of their fraction, by a hash of the index in the
  /// output grid, so that a region has the numbers of the whole output. See Totals for what is lost
  conservative
};

/// The value of output voxels that no tetrahedron covers.
///
/// `nearest` and `falloff` take the displacement (rest minus deformed position) of the nearest
/// point of the deformed mesh's surface: the triangles that one tetrahedron alone has, those into
/// which hexahedra are split included, on which it is linear. They are for samples that stay as
/// they are: Intensity::value and Quantity::components, and need the whole mesh: no SourceWindow.
/// Samples outside of the mesh are not averaged then, and their Jacobian, gradient and strain are
/// zero, but FieldTarget::displacement holds the displacement.
enum class Outside {
  background,  ///< WarpOptions::background
  identity,    ///< the source at the same world position
  nearest,     ///< the source where that displacement leads
  falloff      ///< the same with the displacement times 1 - t^2 (3 - 2 t), t = distance from the
               ///< surface over WarpOptions::falloff; from t = 1 on as identity
};

/// Whether displacements go on outside of the mesh.
constexpr bool extends(Outside outside) {
  return outside == Outside::nearest || outside == Outside::falloff;
}

/// Work that is skipped because it cannot change the result. The output bits do not depend on it
/// (except the quiet bit of signaling NaNs, which interpolation sets and copying keeps).
struct SkipOptions {
  bool rejected_cells = true;  ///< no voxel tests in cells that are certainly outside a tetrahedron
  bool accepted_cells = true;  ///< no voxel tests in cells that are certainly inside a tetrahedron
  bool copied_voxels = true;   ///< voxels of tetrahedra moved by whole voxels are copied, not
                               ///< interpolated
  bool unchanged_steps = true;  ///< the command computes a step equal to the one before only once;
                                ///< Warper::step() always computes
  bool unchanged_tets = true;  ///< tetrahedra whose nodes have not moved since the step before keep
                               ///< their setup; where WarpTarget::holds_previous, cells without a
                               ///< moved tetrahedron are not written again
  bool constant_cells = true;  ///< cells whose samples all have one value are filled, not sampled
  bool interior_cells =
      true;  ///< back end cuda samples cells whose samples lie in the source without
             ///< tests for its border, cells within one tetrahedron without any
  bool background_chunks = true;  ///< the command does not store chunks of files that hold only
                                  ///< background
  /// Rejects and accepts cells as Gascon et al. do, by bit masks of the eight grid points
  /// around each cell, instead of two of them per face, which decide the same. For comparing the
  /// methods; back ends cpu and cuda.
  bool grid_point_masks = false;
};

/// Choices for comparing methods, and for finding faults.
struct WarpExpertOptions {
  SkipOptions skip = {};
};

/// The part of the sources' grid that is in memory, for sources that do not fit as a whole. The
/// warp of a region reads only a part of the sources, which BlockPlanner computes.
struct SourceWindow {
  Region region;  ///< voxels that VolumeView::data of every source holds, in the source grid
  /// Per source the least and the largest sample of component 0 over the whole grid, then of
  /// component 1, and so on. Required with Overshoot::clamp, otherwise not used.
  std::vector<std::vector<double>> ranges = {};
};

/// Options of a warp. The defaults suit most uses.
struct WarpOptions {
  Filter filter = Filter::linear;            ///< 64-bit integers: nearest and labels only
  LabelRule label_rule = LabelRule::linear;  ///< another one only with Filter::labels
  LabelGaussian label_gaussian = {};
  Overshoot overshoot = Overshoot::keep;
  /// Averages where a tetrahedron maps the step from voxel to voxel to more than 1.5 voxels of the
  /// source: one sample per source voxel of the step, at most 16 per axis. Not with nearest and
  /// labels.
  bool antialias = false;
  Intensity intensity = Intensity::value;
  std::vector<Quantity> quantities = {};  ///< one per source; empty: components
  Outside outside = Outside::background;
  double falloff = 0.0;                  ///< of Outside::falloff, above 0 [world]
  double background = 0.0;               ///< rounded to the pixel type, saturated at its limits
  std::optional<Grid> output_grid = {};  ///< nothing: the grid of the sources
  std::optional<Region> region = {};     ///< part of the output grid to compute; nothing: all
  /// Part of the source grid that is in memory; nothing: all. Not with Filter::bspline,
  /// Intensity::conservative and a LabelRule but linear, which read whole sources.
  std::optional<SourceWindow> source_window = {};
  Backend backend = Backend::automatic;
  int device = 0;             ///< CUDA device number
  int threads = 0;            ///< of the cpu back end, up to 1024; 0: all cores
  bool count_folded = false;  ///< fill Counts::folded, which takes a further pass over all voxels
  /// Fill the seconds of stages in Timings on back end cuda, which delays every launch and copy by
  /// two records of events; otherwise only `total` is measured there. Other back ends measure
  /// always.
  bool stage_times = false;
  WarpExpertOptions expert = {};
};

/// Called from within step() or begin_step(), several times per step, with the finished fraction of
/// the step from 0 to 1. Return false to cancel: the call then throws Cancelled.
using Progress = std::function<bool(double fraction)>;

/// Arrays for fields of the deformation, float32 in world axes, [k][j][i][component] over
/// Warper::output_grid(); null: not computed. All are zero where no tetrahedron covers the voxel,
/// but see Outside.
struct FieldTarget {
  /// 3 components, backward: rest position of the material at the voxel minus the voxel's position.
  /// The displacement field by which other programs resample.
  float* displacement = nullptr;
  /// 1 component: det F, with F the derivative of the deformed position by the rest position;
  /// negative where inverted.
  float* jacobian = nullptr;
  float* gradient = nullptr;  ///< 9 components: F, row major
  float* strain = nullptr;    ///< 6 components: (F^T F - I) / 2 (Green-Lagrange), XX YY ZZ XY YZ XZ
  /// 3 components, forward: deformed position of the material that rests at the voxel minus the
  /// voxel's position. It is on the source grid, which the output grid must equal.
  float* forward = nullptr;
};

/// Arrays that a step writes.
struct WarpTarget {
  /// One array per source, each [k][j][i][component] over Warper::output_grid() in the pixel type
  /// of the source.
  std::span<void* const> volumes;
  /// 1 where a tetrahedron covers the voxel, else 0; null: not written.
  std::uint8_t* mask = nullptr;
  /// Number of the mesh's cell that owns the voxel, -1 outside; null: not written.
  std::int32_t* owner = nullptr;
  FieldTarget fields = {};
  Memory memory = Memory::host;  ///< of all arrays
  /// True: the caller guarantees that the arrays still hold what the last step into them wrote, so
  /// that unchanged values need not be written again. Without effect on the first step, after a
  /// step that threw, and for arrays other than those of the last two steps.
  bool holds_previous = false;
  /// cudaStream_t on which the step's kernels run, to order them with the caller's work on device
  /// memory; null: a stream of the Warper, which first waits for the default stream if the step
  /// uses device memory of the caller. cuda only.
  void* stream = nullptr;
};

/// Result of warp().
struct WarpResult {
  Volume volume;
  Report report;
};

/// Warps volumes step by step. Allocates memory once; on cuda the sources stay on the device.
///
/// The owner of a voxel is the tetrahedron of the lowest number whose closed deformed shape
/// contains the voxel's center. Node positions are rounded once, to 2^-20 voxel; owners are then
/// decided in exact integers, so that they are the same on every back end and for every number of
/// threads. Not safe for concurrent calls.
class TETWARP_EXPORT Warper {
 public:
  /// @param sources  at least one volume, all on the same grid, in host memory or (cuda) device
  ///                 memory; their samples must not change during the lifetime of the Warper
  /// @param mesh     rest state; copied
  /// @throws std::invalid_argument  on any bad argument, naming it
  /// @throws CudaError              when `backend` is cuda and the device is not usable
  Warper(std::span<const VolumeView> sources, const Mesh& mesh, const WarpOptions& options = {});
  Warper(const Volume& source, const Mesh& mesh, const WarpOptions& options = {});
  /// By the curved maps of tetrahedra of ten nodes, see CurvedMesh. For values as they are: no
  /// antialias, densities, vectors and tensors, label rules but linear, and forward field; for
  /// these pass split_curved(mesh).
  /// @throws std::invalid_argument  also about these, and what check_mid_nodes() throws
  Warper(std::span<const VolumeView> sources,
         const CurvedMesh& mesh,
         const WarpOptions& options = {});
  Warper(Warper&&) noexcept;
  Warper& operator=(Warper&&) noexcept;
  ~Warper();

  /// The grid of the arrays that a step writes: that of the region, or the whole output grid.
  const Grid& output_grid() const;

  /// Warps all sources by one set of node positions.
  /// @param deformed  finite positions of as many nodes as the mesh has [world]
  /// @param progress  may be empty
  /// @returns timings and counts of this step
  /// @throws std::invalid_argument  on bad arguments
  /// @throws CudaError              when the device fails
  /// @throws Cancelled              when `progress` returned false
  /// @throws std::logic_error       when a step is in flight
  StepReport step(const PositionsView& deformed,
                  const WarpTarget& target,
                  const Progress& progress = {});

  /// Begins a step; finish_step() ends it. On cuda the call returns once the work is queued: the
  /// device downloads one result while it computes the next step and uploads the positions of the
  /// one after. On other back ends the call computes the step. A series in two targets:
  ///
  ///     warper.begin_step(steps[0], targets[0]);
  ///     for (std::size_t k = 1; k < steps.size(); ++k) {
  ///       warper.begin_step(steps[k], targets[k % 2]);
  ///       warper.finish_step();  // targets[(k - 1) % 2] holds step k - 1
  ///     }
  ///     warper.finish_step();
  ///
  /// Results equal those of step() bit for bit. The target's host memory should be page-locked
  /// (PageLock); otherwise the download blocks the calling thread, though not the device.
  ///
  /// @param deformed  as in step(); host memory may be changed after the call, device memory after
  ///                  finish_step()
  /// @param target    as in step(); its arrays, unlike the span, must not be used before
  ///                  finish_step()
  /// @throws std::invalid_argument  on bad arguments; the step has then not begun
  /// @throws std::logic_error       when max_steps_in_flight steps are in flight
  void begin_step(const PositionsView& deformed,
                  const WarpTarget& target,
                  const Progress& progress = {});

  /// Ends the oldest step in flight: waits until its target holds the result.
  /// @returns timings and counts of this step; `total` counts from its begin_step(), so that the
  ///          times of two steps in flight overlap
  /// @throws std::logic_error       when no step is in flight
  /// @throws std::invalid_argument, CudaError, Cancelled  as step(); later steps are not affected
  StepReport finish_step();

  /// Steps begun and not finished.
  std::size_t steps_in_flight() const;
  static constexpr std::size_t max_steps_in_flight = 2;  ///< limit of steps_in_flight()

  /// Warps a single source by one set of node positions.
  /// @returns a new volume on output_grid()
  /// @throws as the other step(); std::invalid_argument when there are several sources
  Volume step(const PositionsView& deformed);

  /// Sums over all finished steps, and their records: all, or of more than 1000 steps those of the
  /// last 500 to 1000, numbered by StepReport::step.
  const Report& report() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Warps one volume by one set of node positions. For several steps a Warper is faster.
/// @throws as Warper and Warper::step()
TETWARP_EXPORT WarpResult warp(const Volume& source,
                               const Mesh& mesh,
                               const std::vector<Point3>& deformed,
                               const WarpOptions& options = {});

}  // namespace tetwarp

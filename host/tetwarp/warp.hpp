/// @file warp.hpp
/// Deform volumes by a tetrahedral mesh: every output voxel takes the sample of the source at the
/// rest position of the material point that the deformed mesh has moved there.
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
#include <tetwarp/mesh.hpp>
#include <tetwarp/report.hpp>
#include <tetwarp/volume.hpp>

namespace tetwarp {

/// What becomes of values beyond the range of the samples, as cubic, bspline and lanczos make them.
enum class Overshoot {
  keep,
  clamp  ///< to the least and largest sample of the source, component by component
};

/// What a voxel gets of a value.
enum class Intensity {
  value,    ///< the value: what a material point shows
  density,  ///< divided by |det F|: what a material point has per volume. The integral stays, as
            ///< far as sampling goes; vectors are turned first
  /// What tetrahedra bring into the voxel's box of the source, which is constant in the box of each
  /// of its voxels, over the box's volume: the integral stays to rounding. Filters have no say.
  conservative
};

/// What a voxel gets that no tetrahedron covers.
enum class Outside {
  background,  ///< the background value
  identity     ///< the source at the same world position
};

/// Work left out because it cannot change the result. Each switch gives the same output bits (but
/// for the quiet bit of signaling NaNs, which interpolation sets and copying keeps).
struct SkipOptions {
  bool rejected_cells = true;   ///< cells certainly outside a tetrahedron are not tested against it
  bool accepted_cells = true;   ///< cells certainly inside a tetrahedron are not tested against it
  bool copied_voxels = true;    ///< tetrahedra moved by whole voxels are copied, not interpolated
  bool unchanged_steps = true;  ///< a step equal to the one before is not computed again (series
                                ///< of files; a single Warper::step() always computes)
  bool unchanged_tets = true;   ///< what has not moved since the step before is not set up again,
                                ///< and cells it alone touches are left as they are where the
                                ///< target holds that step (WarpTarget::holds_previous)
  bool constant_cells = true;   ///< cells that see one value of the source are filled, not sampled
  bool background_chunks = true;  ///< chunks of a file that hold only background are not stored
};

/// The part of the sources' grid that memory holds, for a warp whose sources do not fit as a whole.
/// The warp of a region reads a part of the sources only; BlockPlanner computes which.
struct SourceWindow {
  Region region;  ///< voxels that VolumeView::data of every source holds, in the source grid
  /// Per source the least and the largest sample of component 0 over the whole grid, then of
  /// component 1, and so on. Required with Overshoot::clamp, otherwise not used.
  std::vector<std::vector<double>> ranges = {};
};

/// Choices of a warp. Defaults give what most people want.
struct WarpOptions {
  Filter filter = Filter::linear;  ///< 64-bit integers: nearest and labels only
  Overshoot overshoot = Overshoot::keep;
  /// Where a tetrahedron maps a voxel's step to more than 1.5 voxels of the source, the mean of as
  /// many samples as it has voxels, at most 16 per axis. Not of nearest and labels.
  bool antialias = false;
  Intensity intensity = Intensity::value;
  std::vector<Quantity> quantities = {};  ///< one per source; empty: components
  Outside outside = Outside::background;
  double background = 0.0;               ///< rounded and saturated to the pixel type
  std::optional<Grid> output_grid = {};  ///< nothing: the source's grid
  std::optional<Region> region = {};     ///< part of the output grid to compute; nothing: all
  /// Part of the source grid that is in memory; nothing: all. Not with Filter::bspline and
  /// Intensity::conservative, which read whole sources.
  std::optional<SourceWindow> source_window = {};
  Backend backend = Backend::automatic;
  int device = 0;             ///< CUDA device number
  int threads = 0;            ///< of the cpu back end; 0: all cores
  bool count_folded = false;  ///< also count voxels strictly inside several tetrahedra
  SkipOptions skip = {};
};

/// Told between slabs of work with the finished fraction of the step, 0 to 1; false cancels.
/// Called within step() or begin_step().
using Progress = std::function<bool(double fraction)>;

/// Fields of the deformation, float32 in world axes, [k][j][i][component] over
/// Warper::output_grid(). All are zero where no tetrahedron covers the voxel.
struct FieldTarget {
  /// 3: backward, what a voxel shows was at the voxel's position plus this at rest. The
  /// displacement field that other programs resample by.
  float* displacement = nullptr;
  /// 1: det F, with F the gradient of the deformed position by the rest position; negative where
  /// inverted.
  float* jacobian = nullptr;
  float* gradient = nullptr;  ///< 9: F, row major
  float* strain = nullptr;    ///< 6: Green-Lagrange, (F^T F - I) / 2, as XX YY ZZ XY YZ XZ
  /// 3: the inverse field, on the source grid, which the output grid must be: the voxel's position
  /// plus this is where the step has moved what is at the voxel at rest.
  float* forward = nullptr;
};

/// Where a step writes. Null pointers are outputs nobody asked for. One pointer per source volume,
/// each [k][j][i][component] over Warper::output_grid() in the source's pixel type.
struct WarpTarget {
  std::span<void* const> volumes;
  std::uint8_t* mask = nullptr;   ///< 1 where a tetrahedron covers the voxel, else 0
  std::int32_t* owner = nullptr;  ///< owning cell of the mesh, -1 outside
  FieldTarget fields = {};
  Memory memory = Memory::host;
  /// The buffers hold what a step wrote to them last, untouched: a step then leaves alone what it
  /// would write again. Has no effect on the first step, after one that threw, and on other buffers
  /// than those of the two steps before.
  bool holds_previous = false;
  void* stream = nullptr;  ///< cudaStream_t that orders work on device memory; cuda only
};

/// Results of warp().
struct WarpResult {
  Volume volume;
  Report report;
};

/// Warps volumes step by step, keeping every buffer between steps; on CUDA the sources stay
/// resident.
///
/// The owner of a voxel is the lowest-indexed tetrahedron whose closed deformed shape contains its
/// centre, decided in exact integers after node positions have been rounded once to 2^-20 voxel:
/// the same on every back end and for every thread count. Not safe for concurrent calls.
class Warper {
 public:
  /// @param sources  volumes on one common grid, host or (cuda) device memory, kept by the caller,
  ///                 unchanged, for the life of the Warper; at least one
  /// @param mesh     copied
  /// @param options  see WarpOptions
  /// @throws std::invalid_argument  on any bad argument, naming it
  /// @throws CudaError              when cuda was asked for and no device answers
  Warper(std::span<const VolumeView> sources, const Mesh& mesh, const WarpOptions& options = {});
  Warper(const Volume& source, const Mesh& mesh, const WarpOptions& options = {});
  Warper(Warper&&) noexcept;
  Warper& operator=(Warper&&) noexcept;
  ~Warper();

  /// Grid of what step() writes: the output grid cut to the region, its origin moved accordingly.
  const Grid& output_grid() const;

  /// Warps all sources by one set of node positions.
  /// @param deformed  world, as many nodes as the mesh, finite
  /// @param target    see WarpTarget
  /// @param progress  may be empty
  /// @returns timings and counts of this step
  /// @throws std::invalid_argument, CudaError, Cancelled; std::logic_error while others are in
  /// flight
  StepReport step(const PositionsView& deformed,
                  const WarpTarget& target,
                  const Progress& progress = {});

  /// The first half of step(): asks for the step and comes back. On cuda the device then works on
  /// its own: it brings one result home while it computes the next, and takes the positions of the
  /// one after that. Other back ends compute here. A series in two buffers, the first step begun:
  ///
  ///     for (std::size_t k = 1; k < steps.size(); ++k) {
  ///       warper.begin_step(steps[k], targets[k % 2]);
  ///       warper.finish_step();  // targets[(k - 1) % 2] holds step k - 1
  ///     }
  ///     warper.finish_step();
  ///
  /// Results are those of step(), bit for bit. Host memory should be page-locked (PageLock): else
  /// the copy home keeps the host waiting, though not the device.
  ///
  /// @param deformed  as in step(); host memory may change as soon as this returns, device memory
  ///                  not before finish_step()
  /// @param target    as in step(); its buffers, but not the span, belong to the step until
  ///                  finish_step()
  /// @throws std::invalid_argument  on bad arguments; the step has not begun
  /// @throws std::logic_error       when max_steps_in_flight steps are in flight
  void begin_step(const PositionsView& deformed,
                  const WarpTarget& target,
                  const Progress& progress = {});

  /// The second half of the oldest step in flight: waits until its target holds the result.
  /// @returns timings and counts of this step; `total` counts from its begin_step(), so that those
  ///          of steps in flight at a time overlap
  /// @throws std::logic_error when none is in flight; std::invalid_argument, CudaError, Cancelled:
  ///         what went wrong with this step, told here once. The steps after it are not affected.
  StepReport finish_step();

  std::size_t steps_in_flight() const;
  static constexpr std::size_t max_steps_in_flight = 2;

  /// The same for a single source, into a new volume.
  Volume step(const PositionsView& deformed);

  /// Sums over the finished steps.
  const Report& report() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// One volume, one step. For several steps keep a Warper.
WarpResult warp(const Volume& source,
                const Mesh& mesh,
                const std::vector<Point3>& deformed,
                const WarpOptions& options = {});

}  // namespace tetwarp

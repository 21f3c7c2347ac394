/// @file simulate.hpp
/// Steps the bodies of a Scene through time: backward Euler, one sparse symmetric positive definite
/// system per group of coupled bodies, solved by conjugate gradients.
///
/// Corotational linear finite elements, clamped springs for cloth, rigid bodies with the angular
/// momentum as state. Sources: Gascon 2010/2013; Hauth and Strasser 2004 (corotational elements).
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/backend.hpp>
#include <tetwarp/export.hpp>
#include <tetwarp/mesh.hpp>
#include <tetwarp/scene.hpp>

namespace tetwarp {

/// Work that is left out because it cannot change the result; a member set to false has it done.
struct SimulateSkipOptions {
  bool rotations = true;  ///< of tetrahedra whose nodes did not move
  bool blocks = true;     ///< of the system whose tetrahedra did not turn and whose springs rest
  bool pairs = true;      ///< broad phase of a detection whose boxes lie inside those of an earlier
                          ///< one of the same step
  bool hits = true;     ///< contacts with surfaces that bodies would hit only without the contacts
                        ///< of the step before
  bool islands = true;  ///< coupling islands without contacts are not solved again with contacts
  bool flat_edges = true;  ///< edges and vertices within flat faces of bodies that keep their shape
                           ///< touch nothing: whatever meets one meets another feature as soon
};

/// Choices for comparing methods, and for finding faults.
struct SimulateExpertOptions {
  SimulateSkipOptions skip = {};
};

/// How far a running step is.
struct StepProgress {
  std::int64_t step = 0;               ///< from 0
  double time = 0;                     ///< t_n at its start [s]
  std::int64_t linear_iterations = 0;  ///< of the step so far
};

struct SimulateOptions {
  Backend backend = Backend::automatic;  ///< automatic: cpu, until a device has been measured
  int device = 0;                        ///< CUDA device number
  int threads = 0;             ///< of the cpu back end, 0: all cores; any number: same bits
  bool float32_solve = false;  ///< conjugate gradients on a float32 copy of the system, refined
                               ///< in float64 to the same tolerance
  std::int64_t max_iterations = 10000;  ///< of conjugate gradients per solve
  /// Wall time of a step [s], > 0: solves end in time for a step to take no more, with the best
  /// velocities so far, and steps are divided no further; detection still keeps surfaces apart.
  /// Results then depend on the clock. A step without solves may take longer than that.
  double max_step_seconds = std::numeric_limits<double>::infinity();
  SimulateExpertOptions expert = {};
  bool untangle =
      false;  ///< elastic bodies and cloth that intersect others at the start are shrunk until
              ///< they are apart and grow back within 0.2 s; otherwise they are an error
  /// Called within steps, from the thread that steps; false ends the step, which then has no
  /// effect: step() returns false.
  std::function<bool(const StepProgress&)> progress = {};
};

/// Where SimulateOptions::max_step_seconds ended a step, in counts. A step from an equal state that
/// ends there has the same bits, whatever time it takes, on the back end cpu with one thread:
/// with several threads each ends the sweeps of its own island, which these counts do not include.
struct StepLimit {
  std::int64_t checks = -1;     ///< checks of the time before the one that ended the solves; -1:
                                ///< none did
  std::int64_t divisions = -1;  ///< into more parts before the one for which there was no time;
                                ///< -1: there was for each

  bool operator==(const StepLimit&) const = default;
};

/// Energies [J] at the end positions of a step.
struct SceneEnergy {
  double kinetic = 0;
  double elastic = 0;  ///< of elements, cloth, couplings and handles
  double gravity = 0;  ///< -m g . x
  double adhesion = 0;
  double work = 0;  ///< done so far by scripts, anchors and loads
  double total() const { return kinetic + elastic + gravity + adhesion; }
};

/// Seconds of the stages of a step.
struct StepSeconds {
  double forces = 0, assembly = 0, linear = 0, detection = 0, contact = 0, update = 0, total = 0;
};

/// One body at the end of a step. Forces are impulses over the step divided by time_step.
struct BodyRecord {
  Point3 center{};            ///< of mass [m]
  Point3 velocity{};          ///< of the center of mass [m/s]
  Point3 angular_momentum{};  ///< about the center of mass [kg m^2/s]
  Point3 contact_force{}, support_force{}, handle_force{}, coupling_force{}, load_force{};  ///< [N]
  std::array<double, 4> rotation{1, 0, 0, 0};  ///< rigid: geometry frame to world, w >= 0
  Point3 angular_velocity{};                   ///< rigid [rad/s]
};

/// Where a contact is on a body: a weighted mean of points of BodyMesh::surface, or of the points
/// of an obstacle's mesh.
struct ContactPlace {
  std::array<std::int32_t, 3> point{-1, -1, -1};  ///< -1: not used; all three where a rigid body or
                                                  ///< obstacle does not touch with a vertex
  std::array<double, 3> weight{0, 0, 0};          ///< of the points, sum 1
};

/// One contact at the end of a step.
struct ContactPoint {
  std::size_t body_a = 0, body_b = 0;  ///< in Scene::bodies; from their number on: obstacle
  Point3 position{};                   ///< in the middle between both surfaces [m]
  Point3 normal{};                     ///< unit, from b to a
  Point3 impulse{};                    ///< on a over the last part of the step, world axes [N s]
  double gap = 0;                      ///< along the normal, less the thickness [m]
  double area = 0;                     ///< [m^2]
  double intensity = 0;                ///< beta, of the adhesion
  ContactPlace place_a, place_b;
};

/// Diagnostics of a step; of a new Simulator those of the start.
struct StepRecord {
  double time = 0;  ///< [s]
  SceneEnergy energy;
  Point3 momentum{};          ///< [kg m/s]
  Point3 angular_momentum{};  ///< about the world's origin [kg m^2/s]
  std::int64_t inverted = 0;  ///< tetrahedra of negative volume
  std::int64_t islands = 0, sleeping = 0, substeps = 0;
  std::int64_t linear_iterations = 0;
  double linear_residual = 0;  ///< largest of an island, relative
  bool converged = true;       ///< whether all solves reached their tolerance
  bool out_of_time = false;    ///< whether SimulateOptions::max_step_seconds ended solves
  std::int64_t skipped_rotations = 0, skipped_blocks = 0;  ///< see SimulateSkipOptions
  std::int64_t contacts = 0;
  std::int64_t contact_passes = 0;   ///< detections of the parts of the step, in all
  std::int64_t clamped_islands = 0;  ///< that moved by a part of a step only, to stay apart
  std::int64_t stalled_scripts = 0;  ///< scripted bodies, obstacles and driven nodes that did
  std::int64_t sweeps = 0, outer_iterations = 0;  ///< of contact solves
  double contact_residual = 0;                    ///< largest eta
  double smallest_distance = 0;  ///< between surfaces that may touch [m], at most 100 thickness
  double adhered_area = 0;       ///< sum of intensity and area [m^2]
  StepSeconds seconds;
  std::vector<BodyRecord> bodies;       ///< as in Scene::bodies
  std::vector<Point3> obstacle_forces;  ///< [N]
  std::vector<Point3> coupling_forces;  ///< on a [N]
};

/// The mesh of a body and what is bound to it; does not change.
struct BodyMesh {
  BodyKind kind = BodyKind::fem;
  double mass = 0;                       ///< [kg]; scripted: 0
  double foreground_volume = 0;          ///< fem, of an image: voxels from the threshold on [m^3]
  double uncovered_volume = 0;           ///< the part of it in no tetrahedron, without mass [m^3]
  std::array<double, 3> cells_across{};  ///< extent over mean cell size; not for rigid
  Mesh mesh;                             ///< fem; nodes in the frame of the geometry
  Surface surface;                       ///< points in the frame of the geometry
  std::vector<double> shear_modulus;     ///< fem: mu of each tetrahedron [Pa]
};

/// A handle that a running simulation gets: springs between anchors and the nodes of a body near a
/// place, or between an anchor and the point of a rigid body at that place.
struct PointHandle {
  std::string name = {};   ///< no handle of the scene has it
  std::string body = {};   ///< not scripted
  Point3 center{0, 0, 0};  ///< [world, now]
  double radius = 0;       ///< nodes up to so far from the center, or else the nearest one [m]
  double stiffness = 0;    ///< in total [N/m]
  double damping = 0;      ///< in total [N s/m]

  bool operator==(const PointHandle&) const = default;
};

/// Advances a scene. Public calls of one object must not overlap.
class TETWARP_EXPORT Simulator {
 public:
  /// @throws std::invalid_argument  in one line naming the body or entry and what is wrong
  /// @throws CudaError              backend cuda without a usable device
  explicit Simulator(Scene scene, const SimulateOptions& options = {});
  ~Simulator();
  Simulator(Simulator&&) noexcept;
  Simulator& operator=(Simulator&&) noexcept;

  const Scene& scene() const;
  std::int64_t step_index() const;  ///< steps done
  double time() const;              ///< [s]
  Backend backend() const;          ///< cpu, cuda or reference
  std::string device() const;       ///< name of the processor or device

  /// Advances by time_step. @returns false if `progress` ended the step
  /// @throws std::runtime_error  one line with step, bodies and remedy: positions would not be
  ///                             finite, or too many surfaces are near each other; the state is as
  ///                             before
  bool step();
  /// The same, but it ends at these counts and not by the clock.
  /// @throws std::invalid_argument  SimulateOptions::max_step_seconds is infinite
  bool step(const StepLimit& limit);
  /// Where the last call of step() ended.
  StepLimit step_limit() const;

  /// The last step's diagnostics, computed on request.
  const StepRecord& record();

  /// The contacts at the end of the last step, ordered by bodies and features.
  std::vector<ContactPoint> contacts() const;
  double thickness() const;  ///< contact distance [m]

  const BodyMesh& body(std::size_t index) const;
  /// World positions of the nodes of body(index).mesh, on the device with backend cuda: valid until
  /// the next step. A Warper takes them as they are.
  PositionsView positions(std::size_t index) const;
  /// World positions and velocities copied to the host.
  std::vector<Point3> node_positions(std::size_t index) const;
  std::vector<Point3> node_velocities(std::size_t index) const;
  std::vector<Point3> surface_positions(std::size_t index) const;

  /// Of each tetrahedron of body(index).mesh: det F, F the derivative of the world position by the
  /// rest position; negative where inverted.
  std::vector<double> cell_jacobians(std::size_t index) const;
  /// Of each tetrahedron of body(index).mesh: the von Mises stress of the corotational law [Pa],
  /// without damping; zero for scripted bodies.
  std::vector<double> cell_stresses(std::size_t index) const;

  /// Moves the anchors of a handle by `displacement` from where they started, instead of its path,
  /// from the next step on. @throws std::invalid_argument if there is no such handle
  void move_handle(const std::string& name, const Point3& displacement);
  /// The springs of a handle let go, until it is moved again.
  void release_handle(const std::string& name);
  /// Adds a handle, whose anchors start where its points are now. move_handle() and
  /// release_handle() take its name, and scene() lists it; one of the same name that was added
  /// before is replaced. A checkpoint has it. Costs about as much as restore().
  /// @throws std::invalid_argument  naming the member, and for the back end reference
  void add_handle(const PointHandle& handle);
  /// The pose of a scripted body or obstacle relative to its start, instead of its path, from the
  /// next step on; axis_angle turns about its origin.
  void move_script(const std::string& name, const Point3& displacement, const Point3& axis_angle);

  /// The whole state, to go on bit for bit in an equal scene with the same options.
  std::vector<std::byte> checkpoint() const;
  /// @throws std::invalid_argument if it is not a checkpoint of this scene
  void restore(std::span<const std::byte> checkpoint);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tetwarp

/// @file scene.hpp
/// A scene for simulations: rigid, elastic and cloth bodies, scripted bodies, obstacles, and what
/// couples, pulls and loads them. Plain data in SI units; angles in radians, world axes.
///
/// Times: step n goes from t_n = n time_step to t_(n+1). It samples paths, hinges, waves and
/// anchors at t_(n+1); a prescribed velocity is the difference over time_step.
#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <tetwarp/camera.hpp>
#include <tetwarp/export.hpp>
#include <tetwarp/scene_parts.hpp>

namespace tetwarp {

enum class BodyKind { fem, rigid, cloth, scripted };

struct Body {
  std::string name = {};
  BodyKind kind = BodyKind::fem;
  Geometry geometry = {};
  Pose pose = {};
  Point3 velocity{0, 0, 0};          ///< at the start [m/s]
  Point3 angular_velocity{0, 0, 0};  ///< at the start, about the center of mass [rad/s]
  bool collide = true;
  std::optional<bool> self = {};  ///< touches itself; without: cloth does, others do not
  std::optional<SurfaceContact> contact = {};
  bool cage_start = false;

  std::optional<Lattice> lattice = {};  ///< fem and scripted, of shapes and images
  SurfaceChoice surface = {};
  Material material = {};
  std::vector<TransferPoint> transfer = {};  ///< fem of an image; replaces `material`
  TransferLookup lookup = TransferLookup::linear;
  MaterialMean mean = MaterialMean::arithmetic;
  MassKind mass = MassKind::consistent;
  Damping damping = {};
  Cloth cloth = {};
  RigidMass rigid = {};
  Motion motion = {};  ///< of scripted bodies
  Selection fixed = {};
  std::vector<DrivenNodes> driven = {};
};

struct PlaneObstacle {
  Point3 normal{0, 0, 1}, point{0, 0, 0};
};
struct SphereObstacle {
  Point3 center{};
  double radius = 1;
};
struct CapsuleObstacle {
  Point3 from{}, to{};
  double radius = 1;
};
struct Obstacle {
  std::string name = {};
  std::variant<PlaneObstacle, SphereObstacle, CapsuleObstacle, Surface> geometry;
  std::optional<SurfaceContact> contact = {};
  Path path = {};
};

/// Springs of rest length 0 between the selected nodes of a and the nearest material points of b.
struct Coupling {
  std::string name = {};       ///< without: a-b
  std::string a = {}, b = {};  ///< bodies or obstacles; b may be "world"
  Selection select_a = {};
  std::vector<Point3> points = {};    ///< instead of a selection: both bodies are tied there
  std::optional<double> within = {};  ///< farthest material point of b [m]; of `points` how far
                                      ///< outside of an elastic body or cloth they may be, without
                                      ///< a twentieth of the diagonal of its box
  double stiffness = 0;               ///< in total [N/m]
  double damping = 0;                 ///< in total [N s/m]
  bool collide = false;
};
/// Springs between selected points and anchors, which start where the points start.
struct Handle {
  std::string name = {};  ///< without: its body's
  std::string body = {};
  Selection select = {};
  double stiffness = 0;  ///< in total [N/m]
  double damping = 0;    ///< in total [N s/m]
  Path path = {};        ///< of the anchors, without turns
};
struct Load {
  std::string body = {};
  Selection select = {};
  std::optional<Point3> force = {};     ///< in total [N]
  std::optional<double> pressure = {};  ///< [Pa], along minus the current normals of triangles
                                        ///< whose points are all selected
  double from = 0;                      ///< acts in steps with from < t_(n+1) <= to [s]
  double to = std::numeric_limits<double>::infinity();
};

struct SceneSolver {
  double contact_tolerance = 1e-4;
  double linear_tolerance = 1e-6;
  int max_passes = 5;
  int max_substeps = 16;
  bool pyramid = false;      ///< law of friction: pyramid instead of cone
  bool restrictive = false;  ///< rule of adhesion: restrictive instead of parallel
  bool sleeping = false;
};
struct SceneOutput {
  std::optional<std::int64_t> every = {};  ///< steps
  double rate = 30;                        ///< frames per second, where `every` is not given
  std::vector<std::string> fields = {};    ///< velocity, stress, jacobian, contact
};

/// A further camera, which pictures and windows choose by its name.
struct SceneCamera {
  std::string name = {};
  Camera camera = {};
};

struct Scene {
  double time_step = 0;  ///< [s], > 0
  double duration = 0;   ///< [s], >= 0
  Point3 gravity{0, 0, -9.81};
  std::optional<double> thickness = {};  ///< contact distance [m]
  std::vector<Body> bodies = {};
  std::vector<Obstacle> obstacles = {};
  std::vector<Coupling> couplings = {};
  std::vector<Handle> handles = {};
  std::vector<Load> loads = {};
  SceneContact contact = {};
  SceneSolver solver = {};
  SceneOutput output = {};
  /// Default camera of pictures and windows; of no effect on the motion.
  std::optional<Camera> camera = {};
  std::vector<SceneCamera> cameras = {};  ///< names differ; of no effect on the motion
  /// What reading its files has merged, a line for each file; of no effect.
  std::vector<std::string> notes = {};

  /// round(duration / time_step)
  TETWARP_EXPORT std::int64_t step_count() const;
};

/// Checks all that needs no mesh of a body: numbers, names, which members a kind of body has, what
/// refers to what. The Simulator and read_scene() call it.
/// @throws std::invalid_argument  in one line: the place as a scene file spells it, the problem and
///         the remedy, e.g. "bodies[2].lattice.cells: ..."
TETWARP_EXPORT void check_scene(const Scene& scene);

}  // namespace tetwarp

/// @file system.hpp
/// A scene as unknowns, masses and springs of the reference. Blocks of three unknowns: the
/// velocities of all nodes, then the linear and the angular velocity of each rigid frame.
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <tetwarp/scene.hpp>

#include "host/reference/simulate/cloth_body.hpp"
#include "host/reference/simulate/fem_body.hpp"
#include "host/reference/simulate/material_point.hpp"
#include "host/reference/simulate/motion.hpp"
#include "host/reference/simulate/rigid_mass.hpp"

namespace tetwarp::reference {

struct BodyPlace {
  int first_node = 0, node_count = 0;
  int rigid = -1;  ///< frame of a rigid body, or of a scripted one without nodes
};

/// A spring of rest length 0 between two points.
struct BindingSpring {
  MaterialPoint a, b;
  double stiffness = 0, damping = 0;  ///< [N/m], [N s/m]
  int coupling = -1, handle = -1;     ///< of a handle b is where its anchor starts
};

/// What a load acts on: points and their shares of the force, or triangles under pressure.
struct LoadPlace {
  std::vector<MaterialPoint> points;
  std::vector<double> shares;                 ///< sum 1; of a pressure: none
  std::vector<std::array<int, 3>> triangles;  ///< of `points`
};

struct System {
  Scene scene;
  SceneGeometry geometry;
  std::vector<BodyPlace> places;
  std::vector<Element> elements;
  std::vector<double> element_gamma;
  std::vector<EdgeSpring> edges;
  MatrixXd mass, mass_alpha;  ///< m_ab, m_ab alpha; [nodes][nodes]
  MatrixXd bend, bend_gamma;
  std::vector<RigidBody> rigids;  ///< frames; obstacles that couplings use come last
  std::vector<BindingSpring> springs;
  std::vector<std::vector<MaterialPoint>> surfaces;  ///< [bodies][points of the surface]
  std::vector<LoadPlace> loads;
  std::vector<bool> is_prescribed;  ///< [blocks]

  int node_count() const { return static_cast<int>(mass.rows()); }
  int block_count() const { return node_count() + 2 * static_cast<int>(rigids.size()); }
  int linear_block(int rigid) const { return node_count() + 2 * rigid; }
};

struct State {
  std::vector<Vector3d> node;      ///< positions
  std::vector<Placement> frame;    ///< center of mass, and axes of the geometry, of each frame
  std::vector<Vector3d> velocity;  ///< [blocks]; of angular blocks omega = R I^-1 R^T L
  std::vector<Vector3d> angular_momentum;  ///< [rigids]
};

/// World inertia of a rigid body whose geometry is turned by R.
Matrix3d inertia_of(const RigidBody& rigid, const Matrix3d& rotation);

Vector3d position_of(const System& system, const State& state, const MaterialPoint& point);

/// dp/dv of a point: blocks and their 3x3 matrices, [w_a 1] or [1, -[R r]x].
struct PointBlock {
  int block;
  Matrix3d matrix;
};
std::vector<PointBlock> jacobian_of(const System& system,
                                    const State& state,
                                    const MaterialPoint& point);

/// What a caller moves instead of its path.
struct Overrides {
  struct Handle {
    bool is_released = false;
    Vector3d displacement = Vector3d::Zero();
  };
  std::vector<std::optional<Handle>> handles;    ///< [handles]
  std::vector<std::optional<PathPlace>> bodies;  ///< [bodies, then obstacles]
  std::vector<double> delay;  ///< [bodies, then obstacles] behind their paths [s]

  static Overrides none_of(const Scene& scene) {
    Overrides result;
    result.handles.resize(scene.handles.size());
    result.bodies.resize(scene.bodies.size() + scene.obstacles.size());
    result.delay.assign(result.bodies.size(), 0);
    return result;
  }
};

/// Indices by name. @throws std::invalid_argument if there is none
int body_named(const Scene& scene, const std::string& name);
std::size_t handle_named(const Scene& scene, const std::string& name);

/// Of Overrides::bodies.
std::size_t script_named(const Scene& scene, const std::string& name);

}  // namespace tetwarp::reference

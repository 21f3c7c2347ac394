/// @file make_system.hpp
/// The System of a scene and its state at the start.
#pragma once
#include "host/reference/simulate/system.hpp"

namespace tetwarp::reference {

System make_system(const Scene& scene, const SceneGeometry& geometry);
State start_of(const System& system);

/// The springs of couplings and handles and the places of loads: the share of each selected point
/// is that of its lumped volume (elastic bodies) or area (others); of given points it is equal.
void add_springs(const State& start, System& system);
void add_loads(System& system);

/// The point of a body's list of points that selections count: a node, or of a rigid body a point
/// of its surface.
MaterialPoint selected_point(const System& system, int body, int index);
/// Its lumped volume or area.
std::vector<double> shares_of(const System& system, int body, const std::vector<int>& selected);

/// The points of the surfaces of all bodies: of elastic ones sums of nodes.
void bind_surfaces(System& system);

/// Indices by name. @throws std::invalid_argument if there is none
int body_named(const Scene& scene, const std::string& name);
std::size_t handle_named(const Scene& scene, const std::string& name);
/// Of Overrides::bodies.
std::size_t script_named(const Scene& scene, const std::string& name);

/// The index of a frame that stands for an obstacle; made where there is none yet.
int obstacle_frame(System& system, int obstacle);

/// The point of body or obstacle `name` nearest to x at the start, and its distance.
struct NearestMaterial {
  MaterialPoint point;
  double distance = 0;
};
NearestMaterial nearest_material(const std::string& name,
                                 const Vector3d& x,
                                 const State& start,
                                 const System& system);
/// The same, but of a rigid body always the point of its frame that is at x.
MaterialPoint tied_point(const std::string& name,
                         const Vector3d& x,
                         const State& start,
                         const System& system);

}  // namespace tetwarp::reference

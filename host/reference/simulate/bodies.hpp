/// @file bodies.hpp
/// ReferenceBodies: the simulator straight from its equations, in float64, serially, with dense
/// matrices. It derives masses, springs and bindings from the scene and its geometry itself.
#pragma once
#include <memory>
#include <vector>

#include <tetwarp/simulate.hpp>

#include "host/scene/scene_geometry.hpp"

namespace tetwarp::reference {

/// All that a step depends on.
struct BodiesState {
  std::vector<Point3> node_positions;  ///< all bodies, [node][x y z]
  std::vector<Point3> node_velocities;
  std::vector<Point3> centers;                   ///< of rigid frames
  std::vector<std::array<double, 4>> rotations;  ///< geometry to world, w x y z
  std::vector<Point3> velocities;                ///< of the centers
  std::vector<Point3> angular_momenta;           ///< about the centers
};

class ReferenceBodies {
 public:
  /// The geometry's paths must outlive it. @throws std::invalid_argument for names that do not
  /// exist
  ReferenceBodies(const Scene& scene, const SceneGeometry& geometry);
  ~ReferenceBodies();
  ReferenceBodies(ReferenceBodies&&) noexcept;
  ReferenceBodies& operator=(ReferenceBodies&&) noexcept;

  /// One step of the scene's length, never divided.
  void step();
  std::int64_t step_index() const;
  double time() const;

  /// World positions and velocities of the nodes of an elastic body, cloth or a scripted lattice.
  std::vector<Point3> node_positions(std::size_t body) const;
  std::vector<Point3> node_velocities(std::size_t body) const;
  /// World positions of the points of the body's surface.
  std::vector<Point3> surface_positions(std::size_t body) const;

  BodiesState state() const;
  void set_state(const BodiesState& state);

  /// Energies, momenta and forces of the last step; of the start before the first.
  StepRecord record() const;
  /// sum_b m_ab of the nodes [kg]; of a rigid body one entry.
  std::vector<double> masses(std::size_t body) const;
  /// Inertia about the center of mass, world axes, rows [kg m^2], of the mass where it is now.
  std::array<double, 9> inertia(std::size_t body) const;

  /// As Simulator::move_handle() and its neighbors.
  void move_handle(const std::string& name, const Point3& displacement);
  void release_handle(const std::string& name);
  void move_script(const std::string& name, const Point3& displacement, const Point3& axis_angle);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace tetwarp::reference

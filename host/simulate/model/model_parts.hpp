/// @file model_parts.hpp
/// The parts of make_model(): each adds one kind of body, or what ties bodies, to a model.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "host/scene/scene_geometry.hpp"
#include "host/simulate/model/model.hpp"

namespace tetwarp {

/// One body that is added to a model. Its nodes have been given numbers from `first_node` on.
struct BodyPart {
  const Body& body;
  const BodyGeometry& geometry;
  std::int32_t index = 0;  ///< in Scene::bodies
  std::int32_t first_node = 0;
};

/// Symmetric 4x4 masses of the nodes of a tetrahedron: 00 01 02 03 11 12 13 22 23 33 [kg].
using TetMass = std::array<double, 10>;
/// Of a uniform density: mass (1 + delta_ab) / 20.
TetMass uniform_mass(double mass);

/// Moduli and masses of tetrahedra. The elements in `tets` from `first_tet` on are those of the
/// body.
struct TetMaterials {
  std::vector<double> lambda, mu;  ///< [Pa]
  std::vector<TetMass> mass;
};
TetMaterials uniform_materials(const BodyPart& part, const ModelTets& tets, std::size_t first_tet);
/// Every foreground voxel counts once, for the tetrahedron that owns it: masses are sums of
/// density x volume x N_a N_b, moduli the means over voxels times the covered part of the volume,
/// which is taken as 0.02 at least.
TetMaterials image_materials(const BodyPart& part, const ModelTets& tets, std::size_t first_tet);

/// Elements, masses and mass-proportional entries of an elastic body.
/// @throws std::invalid_argument  naming the body: flat or inverted tetrahedra, no mass
void add_fem(const BodyPart& part, Model& model);

/// One entry of the constant scalar blocks.
struct ScalarEntry {
  std::int32_t row = 0, column = 0;
  double mass = 0, bend = 0;
};
/// Sums entries of equal row and column, in their order, and appends them sorted.
void add_scalar_entries(std::vector<ScalarEntry> entries, const Damping& damping, Model& model);

/// Springs, bending and lumped masses of a cloth.
void add_cloth(const BodyPart& part, Model& model);
/// Springs and bending of a sheet of squares.
void add_sheet(const BodyPart& part, Model& model, std::vector<ScalarEntry>& entries);
/// Springs and bending of any triangle mesh.
void add_triangle_cloth(const BodyPart& part, Model& model, std::vector<ScalarEntry>& entries);

/// Mass, centre and inertia about it, in the frame of the geometry.
struct RigidProperties {
  double mass = 0;                  ///< [kg]
  Point3 centre{0, 0, 0};           ///< [m]
  std::array<double, 9> inertia{};  ///< row major [kg m^2]
};
/// Of a closed surface filled with a density.
RigidProperties properties_of(const Surface& surface, double density);

/// A rigid body, with its state at the start.
/// @throws std::invalid_argument  naming the body: no volume, inertia not positive
void add_rigid(const BodyPart& part, Model& model);
/// A prescribed frame at `pose`. @returns its number among the rigid bodies
std::int32_t add_frame(std::int32_t body, const Pose& pose, Model& model);

/// Springs of couplings and handles.
/// @throws std::invalid_argument  naming the coupling: nothing within its distance
void add_springs(const Scene& scene, const SceneGeometry& geometry, Model& model);

/// Sets body_island and island_count.
void find_islands(const Scene& scene, Model& model);

/// "bodies[2] 'NAME': "
std::string error_prefix(const BodyPart& part);

}  // namespace tetwarp

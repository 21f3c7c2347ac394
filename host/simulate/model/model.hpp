/// @file model.hpp
/// A scene as the arrays that the stages of a step read: unknowns, elements, springs and masses.
///
/// Unknowns are blocks of three: block i < node_count is the velocity of node i, blocks
/// node_count + 2 r and + 1 are the linear and angular velocity of rigid body r. The system matrix
/// A has one 3x3 block for every pair of blocks that share an element or a spring.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <tetwarp/scene.hpp>

namespace tetwarp {

/// A material point: a weighted sum of up to four nodes, a point fixed in a rigid body, or a point
/// of the world.
struct ModelPoint {
  std::int32_t body = -1;                            ///< index in Scene::bodies; from their
                                                     ///< number on: obstacle; -1: the world
  std::array<std::int32_t, 4> node{-1, -1, -1, -1};  ///< of the model; those not used are -1
  std::array<double, 4> weight{0, 0, 0, 0};          ///< sum 1 over the nodes used
  std::int32_t rigid = -1;                           ///< rigid body of the model
  Point3 local{0, 0, 0};  ///< rigid: from the center of mass in the frame of its principal axes;
                          ///< world: the position at the start
};

/// Constants of tetrahedra, [tet].
struct ModelTets {
  std::vector<std::array<std::int32_t, 4>> nodes;
  std::vector<std::array<double, 9>> gradient;  ///< g_1, g_2, g_3 [1/m]; g_0 = -(g_1+g_2+g_3)
  std::vector<double> volume;                   ///< [m^3]
  std::vector<double> lambda, mu;               ///< [Pa]
  std::vector<double> gamma;                    ///< damping [s]
};
/// Springs along the edges of cloth, [spring]: force stiffness (l - rest_length).
struct ModelEdges {
  std::vector<std::array<std::int32_t, 2>> nodes;
  std::vector<double> stiffness;    ///< [N/m]
  std::vector<double> rest_length;  ///< [m], > 0
  std::vector<double> gamma;        ///< damping [s]
};
/// Springs of rest length 0 between points, [spring].
struct ModelSprings {
  std::vector<ModelPoint> a, b;
  std::vector<double> stiffness;       ///< [N/m]
  std::vector<double> damping;         ///< [N s/m]
  std::vector<std::int32_t> coupling;  ///< index in Scene::couplings, or -1
  std::vector<std::int32_t> handle;    ///< index in Scene::handles, or -1: b is its anchor
};
/// Blocks of A that are constant multiples of the identity, [entry]; (i, j) and (j, i) are two
/// entries, each there once.
struct ModelScalarBlocks {
  std::vector<std::array<std::int32_t, 2>> nodes;
  std::vector<double> mass;        ///< m_ij [kg]
  std::vector<double> mass_alpha;  ///< m_ij alpha [kg/s]
  std::vector<double> bend;        ///< of cloth [N/m]
  std::vector<double> bend_gamma;  ///< bend gamma [N s/m]
};
/// Rigid bodies, and prescribed frames of scripted bodies and obstacles, which stand at the body's
/// origin.
struct ModelRigid {
  std::vector<std::int32_t> body;  ///< as ModelPoint::body
  std::vector<double> mass;        ///< [kg]; prescribed: 0
  std::vector<Point3> inertia;     ///< principal moments [kg m^2]; prescribed: 0
  std::vector<double> alpha;       ///< damping [1/s]
  std::vector<Point3> center;      ///< of mass, in the frame of the geometry [m]
  std::vector<std::array<double, 4>>
      axes;  ///< principal axes to the frame of the geometry, w x y z
};

/// State at the start, or of a step: see dynamics in docs/simulate.md.
struct ModelState {
  std::vector<Point3> position;  ///< [node_count] nodes, then [rigid_count] centers of mass
  std::vector<std::array<double, 4>> rotation;  ///< [rigid_count] principal axes to world, w x y z
  std::vector<Point3> velocity;                 ///< [block_count]
  std::vector<Point3> angular_momentum;         ///< [rigid_count]
};

struct Model {
  std::int32_t node_count = 0, rigid_count = 0;
  std::int64_t block_count() const { return node_count + 2 * std::int64_t{rigid_count}; }

  std::vector<std::int32_t> body_node;   ///< [bodies + 1] first node of each body
  std::vector<std::int32_t> body_rigid;  ///< [bodies] rigid body of each body, or -1
  std::vector<std::uint8_t> prescribed;  ///< [block_count] velocity is given, no unknown
  std::vector<double> node_mass;         ///< row sums of the mass [kg]
  std::vector<double> body_foreground;   ///< [bodies] of elastic ones of an image the volume of the
                                         ///< voxels at or above the threshold [m^3], else 0
  std::vector<double> body_covered;      ///< [bodies] the part of it in tetrahedra [m^3]
  ModelTets tets;
  ModelEdges edges;
  ModelSprings springs;
  ModelScalarBlocks scalar_blocks;  ///< sorted by (row, column)
  ModelRigid rigid;

  /// Coupling islands: components of bodies with unknowns over springs between two of them; blocks
  /// of an island are listed together. Bodies without unknowns are in none.
  std::vector<std::int32_t> body_island;  ///< [bodies] or -1
  std::int32_t island_count = 0;
  /// Coupling island of a body or obstacle, or -1.
  std::int32_t island_of(std::int32_t body) const {
    const auto b = static_cast<std::size_t>(body);
    return b < body_island.size() ? body_island[b] : -1;
  }

  ModelState start;
};

struct SceneGeometry;
/// @pre check_scene() has passed
/// @throws std::invalid_argument  in one line naming the body or coupling: no mass or volume, flat
///         elements, nothing within the distance of a coupling
Model make_model(const Scene& scene, const SceneGeometry& geometry);

}  // namespace tetwarp

/// @file scene_geometry.hpp
/// The bodies of a scene as nodes, tetrahedra and triangles: lattices of shapes and images, sheets,
/// surfaces and selected nodes, before anything has mass.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include <tetwarp/scene.hpp>

namespace tetwarp {

/// Nodes that follow a path.
struct DrivenGroup {
  std::vector<std::int32_t> nodes;
  const Path* path = nullptr;  ///< of the scene
};

/// One body. Positions are in the frame of the geometry; pose_of() takes them to the world.
struct BodyGeometry {
  std::vector<Point3> nodes;                      ///< fem, cloth and scripted bodies; rigid: none
  std::vector<std::array<std::int32_t, 4>> tets;  ///< positive volume, none without a node
  std::vector<double> tet_fraction;  ///< volume of each tetrahedron inside a shape over its own
                                     ///< volume, (0, 1]; empty: 1
  bool shares_voxels = false;  ///< of an image: cells are small, so that tetrahedra share the boxes
                               ///< of voxels; false: each voxel is its owner's
  std::array<std::int64_t, 2> sheet_cells{0, 0};  ///< of a sheet: nodes are [v][u], u fastest
  std::vector<std::array<std::int32_t, 3>> cloth_triangles;  ///< cloth: of its nodes
  Surface surface;  ///< points in the geometry's frame; cloth: its nodes; may be empty for scripted
  std::vector<std::int32_t> surface_node;  ///< the node that each point of `surface` is, where it
                                           ///< is the boundary of `tets`; empty: it is not
  bool has_whole_faces = false;  ///< `surface` is that of a shape whose flat faces are not divided
  std::array<double, 3> cells_across{0, 0, 0};  ///< extent over mean edge length of cells

  std::vector<std::int32_t> fixed;  ///< sorted, unique
  std::vector<DrivenGroup> driven;  ///< of disjoint nodes, disjoint from `fixed`
};

/// A load or coupling or handle, with what its selections select, by index of the scene's lists.
/// Nodes of the body; of a rigid body points of its surface.
struct SceneGeometry {
  std::vector<BodyGeometry> bodies;                       ///< as Scene::bodies
  std::vector<std::vector<std::int32_t>> coupling_nodes;  ///< of a; empty if `points` are given
  std::vector<std::vector<std::int32_t>> handle_nodes;
  std::vector<std::vector<std::int32_t>> load_nodes;  ///< pressure: points of the surface
};

/// x_world of a point of the body's frame at the start.
Point3 world_of(const Pose& pose, const Point3& point);

/// @pre check_scene() has passed
/// @throws std::invalid_argument  in one line naming the place and the remedy: a selection that
///         selects nothing, a surface that is not closed, no foreground, too many tetrahedra
SceneGeometry make_scene_geometry(const Scene& scene);

}  // namespace tetwarp

/// @file point_move.hpp
/// Stage "points": the owner of a point that may lie anywhere, and its place after the deformation.
#pragma once
#include <cstdint>

#include "kernels/base/atomic_add.hpp"
#include "kernels/base/hex_view.hpp"
#include "kernels/base/vec3.hpp"
#include "kernels/base/view.hpp"
#include "kernels/warp/curve_map.hpp"
#include "kernels/warp/face_sign.hpp"
#include "kernels/warp/hex_map.hpp"

namespace tetwarp {

/// Faces of a tetrahedron: unit normals that point inward, and the values at the low corner of all
/// tetrahedra [quantum].
struct PointPlanes {
  double normal[4][3];
  double at_low[4];
};

/// A uniform grid of cubes over the box of all tetrahedra, each with those that may hold a point of
/// it.
struct PointCubes {
  std::int64_t low[3], high[3];  ///< closed box [quantum]
  double per_edge;               ///< 1 over the edge of a cube [1/quantum]
  std::int64_t dims[3];
  double margin;                   ///< plane values beyond it have the right sign [quantum]
  View<const std::int64_t> first;  ///< [cubes + 1]: of a cube, in `tets`
  View<const std::int32_t> tets;   ///< ascending in every cube

  /// Number of the cube along an axis, the same function of x for points and boxes.
  TETWARP_HD std::int64_t place(std::int64_t x, int axis) const {
    return static_cast<std::int64_t>(static_cast<double>(x - low[axis]) * per_edge);
  }
  TETWARP_HD std::int64_t cube_at(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return i + dims[0] * (j + dims[1] * k);
  }
  TETWARP_HD std::int64_t count() const { return dims[0] * dims[1] * dims[2]; }
  /// The cube of a point; -1: none.
  TETWARP_HD std::int64_t cube_of(const Node& point) const {
    if (point.x[0] == bad_node) return -1;
    for (int axis = 0; axis < 3; ++axis) {
      if (point.x[axis] < low[axis] || point.x[axis] > high[axis]) return -1;
    }
    return cube_at(place(point.x[0], 0), place(point.x[1], 1), place(point.x[2], 2));
  }
};

/// Whether a closed tetrahedron contains a point: by floating-point planes where they are certain,
/// else in exact integers.
/// @param offset  of the point from cubes.low [quantum]
TETWARP_HD bool holds_point(const PointPlanes& planes,
                            const PointCubes& cubes,
                            const double* offset,
                            View<const Node> nodes,
                            const std::int32_t* tet,
                            const Node& point) {
  double least = cubes.margin + 1;
  for (int face = 0; face < 4; ++face) {
    const double* const n = planes.normal[face];
    const double value =
        n[0] * offset[0] + n[1] * offset[1] + n[2] * offset[2] + planes.at_low[face];
    if (value < -cubes.margin) return false;
    least = min_of(least, value);
  }
  if (least > cubes.margin) return true;
  TetNodes around = tet_nodes(nodes, tet);  // the point becomes the voxel at the origin
  for (auto& node : around.x) {
    for (int axis = 0; axis < 3; ++axis) node[axis] -= point.x[axis];
  }
  return is_inside_exact(around, 0, 0, 0);
}

/// Nodes of a mesh before and after a deformation [world].
struct MovedNodes {
  View<const double> from, to;  ///< [3 * node_count]

  TETWARP_HD Vec3 displacement(std::int64_t node) const {
    return minus(vec3_at(to, node), vec3_at(from, node));
  }
};

/// Barycentric coordinates of a point in the unrounded tetrahedron; of one that is flat, those of
/// its first node.
struct PointWeights {
  double of[4];

  TETWARP_HD PointWeights(const MovedNodes& nodes, const std::int32_t* tet, const Vec3& x) {
    const Vec3 origin = vec3_at(nodes.from, tet[0]);
    const Vec3 a = minus(vec3_at(nodes.from, tet[1]), origin);
    const Vec3 b = minus(vec3_at(nodes.from, tet[2]), origin);
    const Vec3 c = minus(vec3_at(nodes.from, tet[3]), origin);
    const Vec3 offset = minus(x, origin);
    const Vec3 across = cross(b, c);
    const double volume = dot(a, across);
    const double per_volume = volume == 0 ? 0 : 1 / volume;
    of[1] = dot(offset, across) * per_volume;
    of[2] = dot(offset, cross(c, a)) * per_volume;
    of[3] = dot(offset, cross(a, b)) * per_volume;
    of[0] = 1 - of[1] - of[2] - of[3];
  }
};

/// How a point moves with its tetrahedron.
TETWARP_HD Vec3 tet_motion(const MovedNodes& nodes,
                           const std::int32_t* tet,
                           const PointWeights& weights) {
  const Vec3 first = nodes.displacement(tet[0]);
  Vec3 motion = first;
  for (int a = 1; a < 4; ++a) {
    motion = plus(motion, times(weights.of[a], minus(nodes.displacement(tet[a]), first)));
  }
  return motion;
}

/// How a point moves with the hexahedron that its tetrahedron is part of: by the trilinear weights,
/// found by Newton's method from those of the tetrahedron.
TETWARP_HD_RARE Vec3 hex_motion(const MovedNodes& nodes,
                                const std::int32_t* hex,
                                const std::int32_t* tet,
                                const PointWeights& weights,
                                const Vec3& x) {
  const Vec3 origin = vec3_at(nodes.from, hex[0]);
  double size = 0;
  for (int a = 1; a < 8; ++a) {
    const Vec3 edge = minus(vec3_at(nodes.from, hex[a]), origin);
    for (int axis = 0; axis < 3; ++axis) size = max_of(size, fabs(edge[axis]));
  }
  constexpr double voxels = 64;  // along a hexahedron: the tolerance of invert_hex() is in voxels
  const double scale = size > 0 ? voxels / size : 0;
  HexCorners from, motion;
  double target[3], u[3] = {0, 0, 0}, mean[3];
  for (int a = 0; a < 8; ++a) {
    const Vec3 place = times(scale, minus(vec3_at(nodes.from, hex[a]), origin));
    const Vec3 moved = nodes.displacement(hex[a]);
    for (int axis = 0; axis < 3; ++axis) {
      from.at[a][axis] = place[axis];
      motion.at[a][axis] = moved[axis];
    }
  }
  for (int axis = 0; axis < 3; ++axis) target[axis] = scale * (x[axis] - origin[axis]);
  for (int n = 0; n < 4; ++n) {
    int a = 0;
    while (a < 7 && hex[a] != tet[n]) ++a;
    for (int axis = 0; axis < 3; ++axis) u[axis] += weights.of[n] * unit_corner(a, axis);
  }
  invert_hex(hex_terms(from), target, u);
  Matrix3 gradient;
  map_hex(hex_terms(motion), u, mean, gradient);
  return vec3_of(mean);
}

/// How a point moves with a tetrahedron of ten nodes: by the shape functions at the coordinates
/// that Newton's method finds from those in the straight tetrahedron.
/// @returns false where the curved map has none
TETWARP_HD_RARE bool curve_motion(const MovedNodes& nodes,
                                  const std::int32_t* tet,
                                  const std::int32_t* mid_nodes,
                                  const PointWeights& weights,
                                  const Vec3& x,
                                  Vec3& motion) {
  const Vec3 origin = vec3_at(nodes.from, tet[0]);
  double size = 0;
  for (int a = 1; a < 4; ++a) {
    const Vec3 edge = minus(vec3_at(nodes.from, tet[a]), origin);
    for (int axis = 0; axis < 3; ++axis) size = max_of(size, fabs(edge[axis]));
  }
  constexpr double voxels = 64;  // along an edge: tolerances of invert_curve() are in voxels
  const double scale = size > 0 ? voxels / size : 0;
  CurveNodes from, moved;
  double target[3], u[3] = {weights.of[1], weights.of[2], weights.of[3]}, mean[3];
  for (int n = 0; n < 10; ++n) {
    const std::int32_t node = n < 4 ? tet[n] : mid_nodes[n - 4];
    const Vec3 place = times(scale, minus(vec3_at(nodes.from, node), origin));
    const Vec3 step = nodes.displacement(node);
    for (int axis = 0; axis < 3; ++axis) {
      from.at[n][axis] = place[axis];
      moved.at[n][axis] = step[axis];
    }
  }
  for (int axis = 0; axis < 3; ++axis) target[axis] = scale * (x[axis] - origin[axis]);
  if (!invert_curve(curve_terms(from), target, u)) return false;
  Matrix3 gradient;
  map_curve(curve_terms(moved), u, mean, gradient);
  motion = vec3_of(mean);
  return true;
}

/// Whether the middle nodes are within a quantum of the middles of their edges along each axis.
TETWARP_HD bool is_straight(const IndexFromWorld& map,
                            View<const double> positions,
                            const std::int32_t* tet,
                            const std::int32_t* mid_nodes) {
  constexpr std::int64_t no_frame[3] = {0, 0, 0};
  Node nodes[10];
  std::int32_t numbers[10];
  for (int n = 0; n < 10; ++n) {
    numbers[n] = n;
    const std::int32_t node = n < 4 ? tet[n] : mid_nodes[n - 4];
    nodes[n] = quantized(map, positions.data + 3 * std::int64_t{node}, no_frame);
    if (nodes[n].x[0] == bad_node) return false;
  }
  return is_straight(View<const Node>{nodes, 10}, numbers, numbers + 4);
}

/// One index = one point; any order.
struct PointMoveOp {
  IndexFromWorld map;
  PointCubes cubes;
  View<const PointPlanes> planes;  ///< [tet_count]; of flat tetrahedra not set, no cube has them
  View<const Node> rounded;        ///< nodes where the points are [quantum]
  View<const std::int32_t> tets;   ///< [4 * tet_count]
  HexView hexes;
  CurveView curves;
  MovedNodes nodes;
  View<double> points;        ///< in and out, [3 * point_count], world
  View<std::int32_t> owners;  ///< out, [point_count], cell or -1
  /// Points in tetrahedra of ten nodes whose curved map has no inverse there are added to it.
  View<std::int64_t> straightened;

  /// The tetrahedron of the lowest number that contains the point; -1: none.
  TETWARP_HD std::int64_t owner_of(const Node& point) const {
    const std::int64_t cube = cubes.cube_of(point);
    if (cube < 0) return -1;
    double offset[3];
    for (int axis = 0; axis < 3; ++axis) {
      offset[axis] = static_cast<double>(point.x[axis] - cubes.low[axis]);
    }
    const std::int64_t end = cubes.first[cube + 1];
    for (std::int64_t entry = cubes.first[cube]; entry < end; ++entry) {
      const std::int64_t t = cubes.tets[entry];
      if (holds_point(planes[t], cubes, offset, rounded, tets.data + 4 * t, point)) return t;
    }
    return -1;
  }

  TETWARP_HD Node rounded_point(std::int64_t p) const {
    constexpr std::int64_t no_frame[3] = {0, 0, 0};
    return quantized(map, points.data + 3 * p, no_frame);
  }

  TETWARP_HD void operator()(std::int64_t p) const {
    double* const at = points.data + 3 * p;
    const std::int64_t t = owner_of(rounded_point(p));
    if (t < 0) {
      owners[p] = -1;
      return;
    }
    owners[p] = static_cast<std::int32_t>(hexes.cell_of(t));
    const std::int32_t* const tet = tets.data + 4 * t;
    const Vec3 x = vec3_of(at);
    const PointWeights weights(nodes, tet, x);
    Vec3 motion = hexes.has(t) ? hex_motion(nodes, hexes.nodes_of(t), tet, weights, x)
                               : tet_motion(nodes, tet, weights);
    if (curves.has(t)) set_curve_motion(t, weights, x, motion);
    for (int axis = 0; axis < 3; ++axis) at[axis] = x[axis] + motion[axis];
  }

 private:
  /// @param motion  in: that of the straight tetrahedron
  TETWARP_HD_RARE void set_curve_motion(std::int64_t t,
                                        const PointWeights& weights,
                                        const Vec3& x,
                                        Vec3& motion) const {
    const std::int32_t *const tet = tets.data + 4 * t, *const mid = curves.nodes_of(t);
    if (is_straight(map, nodes.from, tet, mid) && is_straight(map, nodes.to, tet, mid)) return;
    if (!curve_motion(nodes, tet, mid, weights, x, motion)) atomic_add(&straightened[0], 1);
  }
};

/// Owners of points, and their places after the deformation.
///
/// @param exec  where to run
/// @param body  input and output, see PointMoveOp
///
/// Determinism: owners are exact; places within 2^-48 of the cell's size and motion between back
/// ends, in hexahedra and tetrahedra of ten nodes within 2^-36. Cost: about four tetrahedra tested
/// per point, 128 bytes each. Source: ours.
template <class Exec>
void point_move(Exec& exec, const PointMoveOp& op) {
  exec.for_each("points/move", op.owners.size, op);
}

}  // namespace tetwarp

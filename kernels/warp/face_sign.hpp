/// @file face_sign.hpp
/// Exact test on which side of a face a voxel center lies, by 128-bit integers on quantized nodes.
/// Points on a face are inside: tetrahedra are closed.
///
/// Bounds: with nodes of a tetrahedron at most 2^40 quanta (2^20 voxels) apart, a normal component
/// is below 2 * 2^80, and a plane value within 16 voxels of the box below 3 * 2^81 * 2^41 < 2^124.
#pragma once
#include <cstdint>

#include "kernels/warp/node_quantize.hpp"

namespace tetwarp {

__extension__ using Int128 = __int128;  // g++ and nvcc both have it

constexpr std::int64_t longest_extent = std::int64_t{1} << 40;  ///< of a tetrahedron [quantum]

/// The four nodes of a tetrahedron.
struct TetNodes {
  std::int64_t x[4][3];  ///< [quantum]
};

TETWARP_HD TetNodes tet_nodes(View<const Node> nodes, const std::int32_t* tet) {
  TetNodes result;
  for (int a = 0; a < 4; ++a) {
    for (int axis = 0; axis < 3; ++axis) result.x[a][axis] = nodes[tet[a]].x[axis];
  }
  return result;
}

/// The plane of the face opposite a node: its normal and one node on it. The normal may point in or
/// out, see turn_inward(). `Integer` must hold twice the square of the tetrahedron's extent.
template <class Integer = Int128>
struct ExactPlane {
  Integer normal[3];
  std::int64_t on[3];
};

/// The plane through three points.
template <class Integer = Int128>
TETWARP_HD ExactPlane<Integer> plane_through(const std::int64_t* o,
                                             const std::int64_t* p,
                                             const std::int64_t* q) {
  std::int64_t u[3], v[3];
  ExactPlane<Integer> plane;
  for (int axis = 0; axis < 3; ++axis) {
    u[axis] = p[axis] - o[axis];
    v[axis] = q[axis] - o[axis];
    plane.on[axis] = o[axis];
  }
  for (int axis = 0; axis < 3; ++axis) {
    const int b = axis == 2 ? 0 : axis + 1;
    const int c = axis == 0 ? 2 : axis - 1;
    plane.normal[axis] = Integer{u[b]} * v[c] - Integer{u[c]} * v[b];
  }
  return plane;
}

/// The nodes of a face in the order in which its plane is computed, n 0 to 2.
TETWARP_HD int face_node(int face, int n) {
  return n < face ? n : n + 1;
}

template <class Integer = Int128>
TETWARP_HD ExactPlane<Integer> exact_plane(const TetNodes& tet, int face) {
  return plane_through<Integer>(tet.x[face_node(face, 0)], tet.x[face_node(face, 1)],
                                tet.x[face_node(face, 2)]);
}

/// Plane value at a point in quanta: positive on the side the normal points to.
template <class Integer>
TETWARP_HD Int128 plane_value(const ExactPlane<Integer>& plane, const std::int64_t* point) {
  Int128 value = 0;
  for (int axis = 0; axis < 3; ++axis) {
    value += Int128{plane.normal[axis]} * (point[axis] - plane.on[axis]);
  }
  return value;
}

/// Makes the normal of the plane opposite node `face` point to that node.
/// @returns six times the tetrahedron's volume [quantum^3]; zero if it is flat
TETWARP_HD Int128 turn_inward(ExactPlane<>& plane, const TetNodes& tet, int face) {
  const Int128 value = plane_value(plane, tet.x[face]);
  if (value >= 0) return value;
  for (int axis = 0; axis < 3; ++axis) plane.normal[axis] = -plane.normal[axis];
  return -value;
}

/// True when voxel center (i, j, k) [frame] is on or inside every face; false for flat tetrahedra.
/// With `strictly`, a voxel on a face is not inside.
TETWARP_HD_RARE bool is_inside_exact(
    const TetNodes& tet, int i, int j, int k, bool strictly = false) {
  const std::int64_t point[3] = {i * quanta_per_voxel, j * quanta_per_voxel, k * quanta_per_voxel};
  for (int axis = 0; axis < 3;
       ++axis) {  // box test first: cheap, and enough for most tiny tetrahedra
    const std::int64_t x[4] = {tet.x[0][axis], tet.x[1][axis], tet.x[2][axis], tet.x[3][axis]};
    if (point[axis] < min_of(min_of(x[0], x[1]), min_of(x[2], x[3]))) return false;
    if (point[axis] > max_of(max_of(x[0], x[1]), max_of(x[2], x[3]))) return false;
  }
  for (int face = 0; face < 4; ++face) {
    ExactPlane<> plane = exact_plane(tet, face);
    if (turn_inward(plane, tet, face) == 0) return false;
    const Int128 value = plane_value(plane, point);
    if (value < 0 || (strictly && value == 0)) return false;
  }
  return true;
}

}  // namespace tetwarp

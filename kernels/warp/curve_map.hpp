/// @file curve_map.hpp
/// Source positions of voxels in tetrahedra of ten nodes, by inverting the quadratic map.
///
/// The tetrahedron of the four corners owns a voxel. The voxel's source position comes from the
/// quadratic map, inverted by Newton's method from the barycentric coordinates in that tetrahedron.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/warp/map_inverse.hpp"
#include "kernels/warp/sample/volume_sample.hpp"
#include "kernels/warp/tet_gradient.hpp"
#include "kernels/warp/tet_setup.hpp"

namespace tetwarp {

/// Which of a tetrahedron's nodes edge e ends at, e from 0 to 5 in VTK's order of middle nodes.
TETWARP_HD int end_of_edge(int e, int side) {
  constexpr int ends[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
  return ends[e][side];
}

/// Middle nodes of the mesh's own tetrahedra.
struct CurveView {
  View<const std::int32_t> nodes;  ///< [6 * tet_count], -1: a tetrahedron of four nodes; may be
                                   ///< empty

  TETWARP_HD bool has(std::int64_t tet) const {
    return 6 * tet < nodes.size && nodes[6 * tet] >= 0;
  }
  /// @pre has(tet)
  TETWARP_HD const std::int32_t* nodes_of(std::int64_t tet) const { return nodes.data + 6 * tet; }
};

/// The ten nodes of a tetrahedron: corners, then middles.
struct CurveNodes {
  double at[10][3];
};

/// A quadratic map as a polynomial of the barycentric coordinates u, v, w of nodes 1 to 3: x = t0 +
/// u t1 + v t2 + w t3 + u u t4 + v v t5 + w w t6 + u v t7 + v w t8 + w u t9.
struct CurveTerms {
  double at[3][10];  ///< [axis][term]
};

/// x = sum_a L_a x_a + sum_edges 4 L_a L_b (x_ab - (x_a + x_b) / 2), the same as the sum over the
/// ten shape functions L_a (2 L_a - 1) and 4 L_a L_b.
TETWARP_HD CurveTerms curve_terms(const CurveNodes& nodes) {
  CurveTerms terms;
  for (int row = 0; row < 3; ++row) {
    double bow[6];
    for (int e = 0; e < 6; ++e) {
      bow[e] = 4 * nodes.at[4 + e][row] -
               2 * (nodes.at[end_of_edge(e, 0)][row] + nodes.at[end_of_edge(e, 1)][row]);
    }
    double* const t = terms.at[row];
    const double first = nodes.at[0][row];
    t[0] = first;
    t[1] = (nodes.at[1][row] - first) + bow[0];
    t[2] = (nodes.at[2][row] - first) + bow[2];
    t[3] = (nodes.at[3][row] - first) + bow[3];
    t[4] = -bow[0];
    t[5] = -bow[2];
    t[6] = -bow[3];
    t[7] = bow[1] - bow[0] - bow[2];
    t[8] = bow[5] - bow[2] - bow[3];
    t[9] = bow[4] - bow[0] - bow[3];
  }
  return terms;
}

/// The quadratic map x(u) and its gradient dx/du.
TETWARP_HD void map_curve(const CurveTerms& curve, const double* u, double* x, Matrix3& gradient) {
  for (int row = 0; row < 3; ++row) {
    const double* const t = curve.at[row];
    const double a = t[1] + u[0] * t[4] + u[1] * t[7];
    const double b = t[2] + u[1] * t[5] + u[2] * t[8];
    const double c = t[3] + u[2] * t[6] + u[0] * t[9];
    gradient.at[row][0] = a + u[0] * t[4] + u[2] * t[9];
    gradient.at[row][1] = b + u[1] * t[5] + u[0] * t[7];
    gradient.at[row][2] = c + u[2] * t[6] + u[1] * t[8];
    x[row] = t[0] + u[0] * a + u[1] * b + u[2] * c;
  }
}

/// How far outside of the curved tetrahedron a place may lie, in barycentric coordinates. Ownership
/// uses straight faces in place of curved ones.
constexpr double curve_margin = 0.25;

/// How near to its target the iteration must have come [voxel]: the coordinates of the largest
/// cells are not finer than that.
constexpr double curve_reach = 0x1p-24;

/// Whether the map is not folded at u, and u lies in the tetrahedron or within curve_margin of it.
/// The map must have the orientation of the straight tetrahedron.
TETWARP_HD bool is_sound(const CurveTerms& curve, const double* u, const Matrix3& gradient) {
  if (!(min_of(u[0], min_of(u[1], u[2])) >= -curve_margin)) return false;
  if (!(u[0] + u[1] + u[2] <= 1 + curve_margin)) return false;
  Matrix3 straight;
  for (int row = 0; row < 3; ++row) {
    const double* const t = curve.at[row];
    for (int axis = 0; axis < 3; ++axis) straight.at[row][axis] = t[1 + axis] + t[4 + axis];
  }
  const double now = determinant(gradient);
  return determinant(straight) > 0 ? now > 0 : now < 0;
}

/// Finds the coordinates u of position `target` from the given u.
/// @returns false where the iteration has not come near, or the place is not sound
TETWARP_HD_RARE bool invert_curve(const CurveTerms& curve, const double* target, double* u) {
  Matrix3 gradient;
  const double far =
      invert_map([&curve](const double* v, double* x, Matrix3& at) { map_curve(curve, v, x, at); },
                 [](double v) { return v; }, target, u, gradient);
  return far <= curve_reach && is_sound(curve, u, gradient);
}

/// How the voxels of a tetrahedron are mapped.
enum class CurveKind : std::int32_t {
  straight,  ///< by the map of its corners: it has four nodes, or its middle nodes add nothing
  curved,
  lost  ///< by the map of its corners, as a middle node is beyond the limits of positions
};

/// The map of a tetrahedron of ten nodes.
struct CurveMap {
  CurveTerms output;      ///< deformed, relative to `from`
  CurveTerms source;      ///< at rest, relative to `whole`
  std::int64_t from[3];   ///< the voxel of the output of its first node [frame]
  std::int64_t whole[3];  ///< the voxel of the source of its first node
};

/// The mesh data that maps are computed from.
struct CurveMesh {
  CurveView curves;
  View<const std::int32_t> tets;  ///< [4 * tet_count]
  View<const Node> nodes;         ///< deformed, in the frame [quantum]
  View<const Node> rest;          ///< in the source's index space [quantum]
  View<const TetSetup> setups;
};

/// Whether the middle nodes lie in the middles of their edges to within a quantum along each axis.
TETWARP_HD bool is_straight(View<const Node> nodes,
                            const std::int32_t* tet,
                            const std::int32_t* mid_nodes) {
  for (int e = 0; e < 6; ++e) {
    const Node &a = nodes[tet[end_of_edge(e, 0)]], &b = nodes[tet[end_of_edge(e, 1)]];
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t off = 2 * nodes[mid_nodes[e]].x[axis] - a.x[axis] - b.x[axis];
      if (off < -2 || off > 2) return false;
    }
  }
  return true;
}

/// Whether the middle nodes move by the whole voxels of a tetrahedron of MapKind::copy.
TETWARP_HD bool moves_whole(const CurveMesh& mesh,
                            const TetSetup& tet,
                            const std::int32_t* mid_nodes) {
  for (int e = 0; e < 6; ++e) {
    const Node &now = mesh.nodes[mid_nodes[e]], &rest = mesh.rest[mid_nodes[e]];
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t shift = static_cast<std::int64_t>(tet.map[3][axis]) - tet.anchor[axis];
      const std::int64_t off = rest.x[axis] - now.x[axis] - shift * quanta_per_voxel;
      if (off < -1 || off > 1) return false;
    }
  }
  return true;
}

/// The ten nodes of tetrahedron t relative to the voxel of the first, which is set.
TETWARP_HD CurveNodes curve_nodes(View<const Node> nodes,
                                  const std::int32_t* tet,
                                  const std::int32_t* mid_nodes,
                                  std::int64_t* from) {
  CurveNodes result;
  for (int axis = 0; axis < 3; ++axis) from[axis] = nodes[tet[0]].x[axis] >> quantum_bits;
  for (int n = 0; n < 10; ++n) {
    const Node& node = nodes[n < 4 ? tet[n] : mid_nodes[n - 4]];
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t quanta = node.x[axis] - from[axis] * quanta_per_voxel;
      result.at[n][axis] = static_cast<double>(quanta) * (1.0 / quanta_per_voxel);
    }
  }
  return result;
}

/// Sets the map of a tetrahedron, unless its voxels are mapped by its corners.
/// @pre tetrahedron t owns a voxel: its corners are within the limits
TETWARP_HD_RARE CurveKind make_curve_map(const CurveMesh& mesh, std::int64_t t, CurveMap& map) {
  if (!mesh.curves.has(t)) return CurveKind::straight;
  const std::int32_t *const tet = mesh.tets.data + 4 * t, *const mid = mesh.curves.nodes_of(t);
  for (int e = 0; e < 6; ++e) {
    if (mesh.nodes[mid[e]].x[0] == bad_node) return CurveKind::lost;
  }
  if (is_straight(mesh.nodes, tet, mid) && is_straight(mesh.rest, tet, mid)) {
    return CurveKind::straight;
  }
  if (mesh.setups[t].kind == MapKind::copy && moves_whole(mesh, mesh.setups[t], mid)) {
    return CurveKind::straight;
  }
  map.output = curve_terms(curve_nodes(mesh.nodes, tet, mid, map.from));
  map.source = curve_terms(curve_nodes(mesh.rest, tet, mid, map.whole));
  return CurveKind::curved;
}

/// Coordinates u of frame voxel x.
/// @param tet  setup of the tetrahedron, which owns x
/// @returns false where the curved map has none
TETWARP_HD bool curve_local(const CurveMap& map, const TetSetup& tet, const int* x, double* u) {
  double target[3], offset[3];
  for (int axis = 0; axis < 3; ++axis) {
    target[axis] = static_cast<double>(x[axis] - map.from[axis]);
    offset[axis] = static_cast<double>(x[axis] - tet.anchor[axis]);
  }
  for (int n = 1; n < 4; ++n) {
    u[n - 1] = ((tet.plane[3][n] + tet.plane[0][n] * offset[0]) + tet.plane[1][n] * offset[1] +
                tet.plane[2][n] * offset[2]) /
               tet.height[n];
  }
  return invert_curve(map.output, target, u);
}

/// Source position at u, as an integer voxel `whole` plus a local part `at`.
TETWARP_HD void curve_source_position(const CurveMap& map,
                                      const double* u,
                                      int* whole,
                                      double* at) {
  Matrix3 gradient;
  map_curve(map.source, u, at, gradient);
  for (int axis = 0; axis < 3; ++axis) {
    const auto first = static_cast<double>(map.whole[axis]);
    const double near = min_of(max_of(floor(at[axis]) + first, -max_whole), max_whole);
    whole[axis] = static_cast<int>(near);
    at[axis] -= near - first;
  }
}

}  // namespace tetwarp

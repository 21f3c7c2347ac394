/// @file hex_map.hpp
/// Source positions of voxels in hexahedra, by inverting the trilinear map.
///
/// A hexahedron is split into tetrahedra, and the one that contains a voxel owns it. The voxel's
/// source position comes from the trilinear map of the whole hexahedron, inverted by Newton's
/// method.
#pragma once
#include <cstdint>

#include "kernels/base/hex_view.hpp"
#include "kernels/base/view.hpp"
#include "kernels/warp/map_inverse.hpp"
#include "kernels/warp/sample/volume_sample.hpp"
#include "kernels/warp/tet_gradient.hpp"

namespace tetwarp {

/// Coordinate along `axis`, 0 or 1, of corner a of the unit cube in VTK's order.
TETWARP_HD int unit_corner(int a, int axis) {
  constexpr int bits[3] = {0b01100110, 0b11001100, 0b11110000};
  return bits[axis] >> a & 1;
}

/// Nodes of a hexahedron relative to a whole voxel [voxel].
struct HexCorners {
  double at[8][3];
};

TETWARP_HD HexCorners hex_corners(View<const Node> nodes,
                                  const std::int32_t* hex,
                                  const std::int64_t* from) {
  HexCorners corners;
  for (int a = 0; a < 8; ++a) {
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t quanta = nodes[hex[a]].x[axis] - from[axis] * quanta_per_voxel;
      corners.at[a][axis] = static_cast<double>(quanta) * (1.0 / quanta_per_voxel);
    }
  }
  return corners;
}

/// A trilinear map as a polynomial: x = t0 + u t1 + v t2 + w t3 + u v t4 + v w t5 + w u t6 +
/// u v w t7, with local coordinates u, v, w from 0 to 1.
struct HexTerms {
  double at[3][8];  ///< [axis][term]
};

TETWARP_HD HexTerms hex_terms(const HexCorners& hex) {
  HexTerms terms;
  for (int row = 0; row < 3; ++row) {
    const auto along = [&](int from, int to) { return hex.at[to][row] - hex.at[from][row]; };
    double* const t = terms.at[row];
    t[0] = hex.at[0][row];
    t[1] = along(0, 1);
    t[2] = along(0, 3);
    t[3] = along(0, 4);
    t[4] = along(3, 2) - t[1];
    t[5] = along(4, 7) - t[2];
    t[6] = along(4, 5) - t[1];
    t[7] = (along(7, 6) - along(4, 5)) - t[4];
  }
  return terms;
}

/// The trilinear map x(u) at local coordinates u and its gradient dx/du. Vectors of the CPU repeat
/// this order of operations (host/warp/cpu/rows/row_hex-inl.hpp).
TETWARP_HD void map_hex(const HexTerms& hex, const double* u, double* x, Matrix3& gradient) {
  for (int row = 0; row < 3; ++row) {
    const double* const t = hex.at[row];
    const double turned = t[5] + u[0] * t[7];
    const double along = (t[1] + u[1] * t[4]) + u[2] * (t[6] + u[1] * t[7]);
    gradient.at[row][0] = along;
    gradient.at[row][1] = (t[2] + u[0] * t[4]) + u[2] * turned;
    gradient.at[row][2] = (t[3] + u[0] * t[6]) + u[1] * turned;
    x[row] = ((t[0] + u[1] * t[2]) + u[2] * (t[3] + u[1] * t[5])) + u[0] * along;
  }
}

/// How far outside of [0, 1] local coordinates may lie. Ownership uses two triangles in place of a
/// curved face, so some owned voxels are slightly outside of the hexahedron.
constexpr double hex_margin = 0.25;

/// Finds the local coordinates u of position `target` from the given u, whose steps are clamped to
/// [-hex_margin, 1 + hex_margin].
TETWARP_HD_RARE void invert_hex(const HexTerms& hex, const double* target, double* u) {
  Matrix3 gradient;
  invert_map([&hex](const double* v, double* x, Matrix3& at) { map_hex(hex, v, x, at); },
             [](double v) { return min_of(max_of(v, -hex_margin), 1 + hex_margin); }, target, u,
             gradient);
}

/// The deformed and the rest shape of a hexahedron.
struct HexShape {
  HexTerms output;        ///< relative to `from`
  HexTerms source;        ///< relative to `whole`
  std::int64_t from[3];   ///< the voxel of the output of its first node [frame]
  std::int64_t whole[3];  ///< the voxel of the source of its first node
};

/// Where Newton's method begins for the voxels of a tetrahedron: by its affine map.
struct HexStart {
  /// Local coordinates are at[0] x + at[1] y + at[2] z + at[3], positions relative to
  /// HexShape::from.
  double at[4][3];
};

/// The map of a hexahedron for the voxels of one of its tetrahedra.
struct HexMap {
  HexShape shape;
  HexStart start;
};

/// The mesh data that maps of hexahedra are computed from.
struct HexMesh {
  HexView hexes;
  View<const std::int32_t> tets;  ///< [4 * tet_count]
  View<const Node> nodes;         ///< deformed, in the frame [quantum]
  View<const Node> rest;          ///< in the source's index space [quantum]
};

/// The hexahedron that tetrahedron t is part of. @pre mesh.hexes.has(t)
TETWARP_HD HexShape make_hex_shape(const HexMesh& mesh, std::int64_t t) {
  const std::int32_t* const hex = mesh.hexes.nodes_of(t);
  HexShape shape;
  for (int axis = 0; axis < 3; ++axis) {
    shape.from[axis] = mesh.nodes[hex[0]].x[axis] >> quantum_bits;
    shape.whole[axis] = mesh.rest[hex[0]].x[axis] >> quantum_bits;
  }
  shape.output = hex_terms(hex_corners(mesh.nodes, hex, shape.from));
  shape.source = hex_terms(hex_corners(mesh.rest, hex, shape.whole));
  return shape;
}

/// @param tet  setup of t
TETWARP_HD HexStart make_hex_start(const HexMesh& mesh,
                                   const HexShape& shape,
                                   std::int64_t t,
                                   const TetSetup& tet) {
  const std::int32_t* const hex = mesh.hexes.nodes_of(t);
  HexStart start = {};
  for (int face = 0; face < 4; ++face) {
    int a = 0;
    while (a < 7 && hex[a] != mesh.tets[4 * t + face]) ++a;
    const double per_height = 1.0 / tet.height[face];
    double at_origin = tet.plane[3][face];
    for (int axis = 0; axis < 3; ++axis) {
      at_origin += tet.plane[axis][face] * static_cast<double>(shape.from[axis] - tet.anchor[axis]);
    }
    for (int axis = 0; axis < 3; ++axis) {
      if (unit_corner(a, axis) == 0) continue;
      for (int term = 0; term < 3; ++term) {
        start.at[term][axis] += tet.plane[term][face] * per_height;
      }
      start.at[3][axis] += at_origin * per_height;
    }
  }
  return start;
}

/// The map of the hexahedron that tetrahedron t is part of.
/// @param tet  setup of t
/// @pre mesh.hexes.has(t)
TETWARP_HD HexMap make_hex_map(const HexMesh& mesh, std::int64_t t, const TetSetup& tet) {
  HexMap map;
  map.shape = make_hex_shape(mesh, t);
  map.start = make_hex_start(mesh, map.shape, t, tet);
  return map;
}

/// Local coordinates u of frame voxel x, which the map's tetrahedron owns.
TETWARP_HD_RARE void hex_local(const HexMap& map, const int* x, double* u) {
  double target[3];
  for (int axis = 0; axis < 3; ++axis) {
    target[axis] = static_cast<double>(x[axis] - map.shape.from[axis]);
  }
  const auto& start = map.start.at;
  for (int axis = 0; axis < 3; ++axis) {
    u[axis] = ((start[3][axis] + start[1][axis] * target[1]) + start[2][axis] * target[2]) +
              start[0][axis] * target[0];
  }
  invert_hex(map.shape.output, target, u);
}

/// Gradient of the source position by the output position at u, both in index space.
/// @returns false where the trilinear map is singular
TETWARP_HD bool hex_gradient(const HexMap& map, const double* u, Matrix3& gradient) {
  double x[3];
  Matrix3 output, source;
  map_hex(map.shape.output, u, x, output);
  map_hex(map.shape.source, u, x, source);
  if (determinant(output) == 0) return false;
  gradient = source * inverse(output);
  return true;
}

/// Source position of frame voxel x, as an integer voxel `whole` plus a local part `at`; other
/// parameters as hex_local().
TETWARP_HD void hex_source_position(const HexMap& map, const int* x, int* whole, double* at) {
  double u[3];
  Matrix3 gradient;
  hex_local(map, x, u);
  map_hex(map.shape.source, u, at, gradient);
  for (int axis = 0; axis < 3; ++axis) {
    const auto first = static_cast<double>(map.shape.whole[axis]);
    const double all = floor(at[axis]) + first;
    const double near = min_of(max_of(all, -max_whole), max_whole);
    whole[axis] = static_cast<int>(near);
    at[axis] -= near - first;
  }
}

}  // namespace tetwarp

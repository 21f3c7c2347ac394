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
#include "kernels/warp/tet_gradient.hpp"
#include "kernels/warp/volume_sample.hpp"

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

/// The trilinear map x(u) at local coordinates u, each 0 to 1, and its gradient dx/du.
TETWARP_HD void map_hex(const HexCorners& hex, const double* u, double* x, Matrix3& gradient) {
  for (int row = 0; row < 3; ++row) {
    x[row] = 0;
    for (int axis = 0; axis < 3; ++axis) gradient.at[row][axis] = 0;
  }
  for (int a = 0; a < 8; ++a) {
    double weight[3];
    for (int axis = 0; axis < 3; ++axis) {
      weight[axis] = unit_corner(a, axis) != 0 ? u[axis] : 1 - u[axis];
    }
    for (int axis = 0; axis < 3; ++axis) {
      const double others = weight[(axis + 1) % 3] * weight[(axis + 2) % 3];
      const double slope = unit_corner(a, axis) != 0 ? others : -others;
      for (int row = 0; row < 3; ++row) gradient.at[row][axis] += slope * hex.at[a][row];
    }
    const double all = weight[0] * weight[1] * weight[2];
    for (int row = 0; row < 3; ++row) x[row] += all * hex.at[a][row];
  }
}

/// How far outside of [0, 1] local coordinates may lie. Ownership uses two triangles in place of a
/// curved face, so some owned voxels are slightly outside of the hexahedron.
constexpr double hex_margin = 0.25;

/// Finds the local coordinates u of position `target` by damped Newton iteration from the given u.
/// Steps are clamped to [-hex_margin, 1 + hex_margin] and halved until the distance decreases;
/// stops where no step decreases it.
TETWARP_HD_RARE void invert_hex(const HexCorners& hex, const double* target, double* u) {
  constexpr int max_steps = 30, max_halvings = 6;
  constexpr double exact = 0x1p-32;  // [voxel]: far below the quantum
  const auto distance = [&](const double* x) {
    return max_of(fabs(target[0] - x[0]), max_of(fabs(target[1] - x[1]), fabs(target[2] - x[2])));
  };
  double x[3];
  Matrix3 gradient;
  map_hex(hex, u, x, gradient);
  double left = distance(x);
  for (int step = 0; step < max_steps && left > exact; ++step) {
    const double det = determinant(gradient);
    if (det == 0) return;
    const Matrix3 adjoint = transposed(cofactors(gradient));
    double full[3];
    for (int axis = 0; axis < 3; ++axis) {
      full[axis] = 0;
      for (int row = 0; row < 3; ++row) {
        full[axis] += adjoint.at[axis][row] * (target[row] - x[row]);
      }
      full[axis] /= det;
    }
    const double before = left;
    double share = 1;
    for (int halving = 0; halving <= max_halvings && left >= before; ++halving, share *= 0.5) {
      double tried[3], tried_x[3];
      Matrix3 tried_gradient;
      for (int axis = 0; axis < 3; ++axis) {
        tried[axis] = min_of(max_of(u[axis] + share * full[axis], -hex_margin), 1 + hex_margin);
      }
      map_hex(hex, tried, tried_x, tried_gradient);
      if (!(distance(tried_x) < before)) continue;
      left = distance(tried_x);
      gradient = tried_gradient;
      for (int axis = 0; axis < 3; ++axis) {
        u[axis] = tried[axis];
        x[axis] = tried_x[axis];
      }
    }
    if (left >= before) return;
  }
}

/// The deformed and the rest shape of a hexahedron, relative to points near one of its tetrahedra.
struct HexMap {
  HexCorners output;      ///< relative to the tetrahedron's anchor
  HexCorners source;      ///< relative to `whole`
  std::int64_t whole[3];  ///< a voxel of the source near the hexahedron
  double start[4][3];     ///< local coordinates of the tetrahedron's nodes
};

/// The mesh data that maps of hexahedra are computed from.
struct HexMesh {
  HexView hexes;
  View<const std::int32_t> tets;  ///< [4 * tet_count]
  View<const Node> nodes;         ///< deformed, in the frame [quantum]
  View<const Node> rest;          ///< in the source's index space [quantum]
};

/// The map of the hexahedron that tetrahedron t is part of.
/// @param tet  setup of t
/// @pre mesh.hexes.has(t)
TETWARP_HD HexMap make_hex_map(const HexMesh& mesh, std::int64_t t, const TetSetup& tet) {
  const std::int32_t* const hex = mesh.hexes.nodes_of(t);
  HexMap map;
  map.output = hex_corners(mesh.nodes, hex, tet.anchor);
  for (int axis = 0; axis < 3; ++axis) map.whole[axis] = mesh.rest[hex[0]].x[axis] >> quantum_bits;
  map.source = hex_corners(mesh.rest, hex, map.whole);
  for (int n = 0; n < 4; ++n) {
    int a = 0;
    while (a < 7 && hex[a] != mesh.tets[4 * t + n]) ++a;
    for (int axis = 0; axis < 3; ++axis) map.start[n][axis] = unit_corner(a, axis);
  }
  return map;
}

/// Local coordinates u of frame voxel x.
/// @param map  of the hexahedron
/// @param tet  the tetrahedron of it that owns the voxel
TETWARP_HD_RARE void hex_local(const HexMap& map, const TetSetup& tet, const int* x, double* u) {
  double target[3];
  for (int axis = 0; axis < 3; ++axis) {
    target[axis] = static_cast<double>(x[axis] - tet.anchor[axis]);
    u[axis] = 0;
  }
  for (int face = 0; face < 4; ++face) {
    const double value = tet.plane[0][face] * target[0] + tet.plane[1][face] * target[1] +
                         tet.plane[2][face] * target[2] + tet.plane[3][face];
    const double weight = value / tet.height[face];
    for (int axis = 0; axis < 3; ++axis) u[axis] += weight * map.start[face][axis];
  }
  invert_hex(map.output, target, u);
}

/// Gradient of the source position by the output position at u, both in index space.
/// @returns false where the trilinear map is singular
TETWARP_HD bool hex_gradient(const HexMap& map, const double* u, Matrix3& gradient) {
  double x[3];
  Matrix3 output, source;
  map_hex(map.output, u, x, output);
  map_hex(map.source, u, x, source);
  if (determinant(output) == 0) return false;
  gradient = source * inverse(output);
  return true;
}

/// Source position of frame voxel x, as an integer voxel `whole` plus a local part `at`; other
/// parameters as hex_local().
TETWARP_HD void hex_source_position(
    const TetSetup& tet, const HexMap& map, const int* x, int* whole, double* at) {
  double u[3];
  Matrix3 gradient;
  hex_local(map, tet, x, u);
  map_hex(map.source, u, at, gradient);
  for (int axis = 0; axis < 3; ++axis) {
    const double all = floor(at[axis]) + static_cast<double>(map.whole[axis]);
    const double near = min_of(max_of(all, -max_whole), max_whole);
    whole[axis] = static_cast<int>(near);
    at[axis] -= near - static_cast<double>(map.whole[axis]);
  }
}

}  // namespace tetwarp

/// @file tet_transform.hpp
/// Stage "setup" of a warp that averages, reorients or rescales samples: the transform that each
/// tetrahedron applies to the samples of its voxels.
/// @see voxel_transform.hpp for the application to a voxel
#pragma once
#include <cstdint>
#include <tetwarp/choices.hpp>

#include "kernels/base/atomic_add.hpp"
#include "kernels/base/symmetric_eigen.hpp"
#include "kernels/base/view.hpp"
#include "kernels/warp/tet_gradient.hpp"
#include "kernels/warp/tet_setup.hpp"

namespace tetwarp {

constexpr int max_parts = 16;           ///< most samples averaged per voxel and axis
constexpr double averaged_step = 1.5;   ///< larger steps in the source are averaged [source voxel]
constexpr double step_slack = 0x1p-20;  ///< far larger than the rounding error of a map's step

/// How samples become a voxel's value: their mean over the midpoints of the voxel's parts,
/// multiplied by a matrix, then by a number.
struct VoxelTransform {
  double scale;
  Matrix3 matrix;  ///< see matrix_of()
  int parts[3];    ///< number of parts along each axis of the output
  bool is_plain;   ///< one sample, unchanged
};

TETWARP_HD VoxelTransform plain_transform() {
  return {1.0, identity3(), {1, 1, 1}, true};
}

TETWARP_HD bool is_averaging(const VoxelTransform& transform) {
  return transform.parts[0] > 1 || transform.parts[1] > 1 || transform.parts[2] > 1;
}

/// The transforms of a job, and the constants for computing them.
struct TransformChoice {
  bool averages;  ///< average samples where the source is compressed
  bool divides;   ///< divide by |det F|, F the deformation gradient
  Quantity reorientation;
  GridAxes axes;
  double voxel_ratio;  ///< volume of a source voxel over that of an output voxel
};

/// Number of samples to average along an axis of the output.
/// @param step  change of the source position per output voxel [source voxel]
TETWARP_HD int parts_of(const double* step) {
  const double length = sqrt(step[0] * step[0] + step[1] * step[1] + step[2] * step[2]);
  if (!(length > averaged_step + step_slack)) return 1;
  return static_cast<int>(min_of(ceil(length - step_slack), static_cast<double>(max_parts)));
}

/// The proper rotation nearest to `a` in the Frobenius norm; one of them if several are; the
/// identity for a zero matrix. Its quaternion is an eigenvector of a symmetric 4x4 matrix, so
/// inverted and singular matrices need no special case. Source: P. Davenport, 1968; B. K. P. Horn,
/// 1987.
TETWARP_HD_RARE Matrix3 nearest_rotation(const Matrix3& a) {
  const auto& s = a.at;
  double key[4][4] = {
      {s[0][0] + s[1][1] + s[2][2], s[2][1] - s[1][2], s[0][2] - s[2][0], s[1][0] - s[0][1]},
      {0, s[0][0] - s[1][1] - s[2][2], s[0][1] + s[1][0], s[0][2] + s[2][0]},
      {0, 0, s[1][1] - s[0][0] - s[2][2], s[1][2] + s[2][1]},
      {0, 0, 0, s[2][2] - s[0][0] - s[1][1]}};
  for (int row = 1; row < 4; ++row) {
    for (int column = 0; column < row; ++column) key[row][column] = key[column][row];
  }
  double vectors[4][4];
  symmetric_eigen<4>(key, vectors);
  int best = 0;
  for (int k = 1; k < 4; ++k) best = key[k][k] > key[best][best] ? k : best;
  const double w = vectors[0][best], x = vectors[1][best], y = vectors[2][best],
               z = vectors[3][best];
  return {{{w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)},
           {2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)},
           {2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z}}};
}

/// F times a positive number, from the inverse of F: finite also if that is singular.
TETWARP_HD Matrix3 forward_direction(const Matrix3& backward) {
  Matrix3 forward = transposed(cofactors(backward));
  if (determinant(backward) < 0) {
    for (auto& row : forward.at) {
      for (double& entry : row) entry = -entry;
    }
  }
  return forward;
}

/// The matrix of a reorientation, see reorient(); for principal_tensor the inverse of F.
/// @param backward  the inverse of F, not singular
TETWARP_HD Matrix3 matrix_of(Quantity reorientation, const Matrix3& backward) {
  switch (reorientation) {
    case Quantity::vector:
    case Quantity::tensor:
      return nearest_rotation(forward_direction(backward));
    case Quantity::covariant_vector:
      return transposed(backward);
    case Quantity::contravariant_vector:
      return inverse(backward);
    case Quantity::principal_tensor:
      return backward;
    case Quantity::components:
      break;
  }
  return identity3();
}

/// Six times the signed volume [quantum^3].
TETWARP_HD Int128 volume6_of(const TetNodes& tet) {
  return plane_value(exact_plane(tet, 0), tet.x[0]);
}

/// One index = one tetrahedron; any order.
struct TetTransformOp {
  static constexpr int resident_blocks = 2;  ///< leaves 128 registers per thread: no spills
  View<const TetSetup> setups;
  View<const std::int32_t> tets;
  View<const Node> nodes;
  View<const Node> rest;
  View<const std::uint8_t> moved;  ///< transforms of others are kept; size 0: all are computed
  TransformChoice choice;
  View<VoxelTransform> transforms;
  View<std::int64_t>
      averaged_count;  ///< changed by the number of averaging ones; size 0: not counted

  TETWARP_HD void operator()(std::int64_t t) const {
    if (moved.size > 0 && moved[t] == 0) return;
    const int before = moved.size > 0 && is_averaging(transforms[t]);
    transforms[t] = transform_of(t);
    const int change = static_cast<int>(is_averaging(transforms[t])) - before;
    if (averaged_count.size > 0 && change != 0) atomic_add(&averaged_count[0], change);
  }

  TETWARP_HD VoxelTransform transform_of(std::int64_t t) const {
    VoxelTransform transform = plain_transform();
    const TetSetup& tet = setups[t];
    const bool is_still = tet.kind == MapKind::copy && choice.axes.are_same;
    if (is_still || (tet.tet_class != TetClass::regular && tet.tet_class != TetClass::inverted)) {
      return transform;
    }
    if (choice.averages) {
      for (int axis = 0; axis < 3; ++axis) transform.parts[axis] = parts_of(tet.map[axis]);
    }
    // Volumes as exact integers: their ratio is accurate for thin tetrahedra too.
    const Int128 rest_volume6 = volume6_of(tet_nodes(rest, tets.data + 4 * t));
    if (choice.divides) {
      const Int128 volume6 = volume6_of(tet_nodes(nodes, tets.data + 4 * t));
      transform.scale = fabs(as_double(rest_volume6) / as_double(volume6)) * choice.voxel_ratio;
    }
    const bool turns = choice.reorientation != Quantity::components && rest_volume6 != 0;
    if (turns)
      transform.matrix = matrix_of(choice.reorientation, backward_gradient(tet, choice.axes));
    transform.is_plain = !is_averaging(transform) && !turns && transform.scale == 1;
    return transform;
  }
};

/// Computes the transform of every tetrahedron, or of those that have moved.
///
/// A tetrahedron that moves by whole voxels between grids of the same axes is plain, so that its
/// voxels are copies; one that is flat at rest does not reorient.
/// @param exec            where to run
/// @param setups          from tet_setup, shape [tet_count]
/// @param tets            node indices, shape [4 * tet_count]
/// @param nodes           deformed, in the frame [quantum]
/// @param rest            in the source's index space [quantum]
/// @param moved           from tet_moved; empty: all have moved
/// @param choice          see TransformChoice
/// @param transforms           in and out, shape [tet_count]
/// @param averaged_count  in and out: tetrahedra that average, shape [1]; empty: not counted
///
/// Determinism: numbers of parts are the same on every back end; matrices agree within 2^-48
/// relative times the condition number of F. Cost: about 1500 operations per rotation.
/// Source: R of finite strain and F: D. C. Alexander et al., 2001.
template <class Exec>
void tet_transform(Exec& exec,
                   View<const TetSetup> setups,
                   View<const std::int32_t> tets,
                   View<const Node> nodes,
                   View<const Node> rest,
                   View<const std::uint8_t> moved,
                   const TransformChoice& choice,
                   View<VoxelTransform> transforms,
                   View<std::int64_t> averaged_count) {
  exec.for_each(
      "warp/setup", transforms.size,
      TetTransformOp{setups, tets, nodes, rest, moved, choice, transforms, averaged_count});
}

}  // namespace tetwarp

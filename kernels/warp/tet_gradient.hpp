/// @file tet_gradient.hpp
/// The deformation gradient of a tetrahedron in world axes, and operations on 3x3 matrices.
#pragma once
#include "kernels/base/hd.hpp"
#include "kernels/warp/tet_setup.hpp"

namespace tetwarp {

struct Matrix3 {
  double at[3][3];  ///< row, column
};

TETWARP_HD Matrix3 identity3() {
  return {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
}

TETWARP_HD Matrix3 operator*(const Matrix3& a, const Matrix3& b) {
  Matrix3 product;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      product.at[row][column] = a.at[row][0] * b.at[0][column] + a.at[row][1] * b.at[1][column] +
                                a.at[row][2] * b.at[2][column];
    }
  }
  return product;
}

TETWARP_HD Matrix3 transposed(const Matrix3& a) {
  Matrix3 result;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) result.at[row][column] = a.at[column][row];
  }
  return result;
}

/// The cofactor matrix: a * transposed(cofactors(a)) is det(a) times the identity.
TETWARP_HD Matrix3 cofactors(const Matrix3& a) {
  Matrix3 result;
  for (int row = 0; row < 3; ++row) {
    const int r1 = (row + 1) % 3, r2 = (row + 2) % 3;
    for (int column = 0; column < 3; ++column) {
      const int c1 = (column + 1) % 3, c2 = (column + 2) % 3;
      result.at[row][column] = a.at[r1][c1] * a.at[r2][c2] - a.at[r1][c2] * a.at[r2][c1];
    }
  }
  return result;
}

TETWARP_HD double determinant(const Matrix3& a) {
  const Matrix3 c = cofactors(a);
  return a.at[0][0] * c.at[0][0] + a.at[0][1] * c.at[0][1] + a.at[0][2] * c.at[0][2];
}

/// @pre determinant(a) is not 0
TETWARP_HD Matrix3 inverse(const Matrix3& a) {
  const double scale = 1.0 / determinant(a);
  Matrix3 result = transposed(cofactors(a));
  for (auto& row : result.at) {
    for (double& entry : row) entry *= scale;
  }
  return result;
}

/// Axes of the source and output grids in the world.
struct GridAxes {
  Matrix3 source;  ///< column a: the step from voxel to voxel along axis a of the source [world]
  Matrix3 output_index;  ///< world to index space of the output grid
  bool are_same;         ///< both grids have the same axes
};

/// Volume of a voxel of the source over that of a voxel of the output.
TETWARP_HD double voxel_ratio_of(const GridAxes& axes) {
  return axes.are_same ? 1.0 : fabs(determinant(axes.source) * determinant(axes.output_index));
}

/// Gradient of the rest position by the deformed one: the inverse of the deformation gradient.
/// Exactly the identity for a whole-voxel shift between grids of the same axes.
/// @pre the tetrahedron is regular or inverted
TETWARP_HD Matrix3 backward_gradient(const TetSetup& tet, const GridAxes& axes) {
  if (tet.kind == MapKind::copy && axes.are_same) return identity3();
  Matrix3 map;
  for (int row = 0; row < 3; ++row) {
    for (int axis = 0; axis < 3; ++axis) map.at[row][axis] = tet.map[axis][row];
  }
  return axes.source * map * axes.output_index;
}

}  // namespace tetwarp

/// @file voxel_share.hpp
/// The share of a voxel's box that a tetrahedron has, and integrals over it.
#pragma once
#include "kernels/warp/overlap/convex_part.hpp"

namespace tetwarp {

/// Of the part of a voxel's box within a tetrahedron; N_a is 1 at node a and 0 at the others.
struct VoxelShare {
  double volume = 0;        ///< over that of the box, 0 to 1
  double product[10] = {};  ///< integrals of N_a N_b over the part, over the volume of the box: 00
                            ///< 01 02 03 11 12 13 22 23 33
};

/// Adds a tetrahedron. The integral of a product of linear functions f, g over a volume V with the
/// corner values f_i, g_i is V / 20 (sum f_i g_i + sum f_i sum g_i).
/// @param at  N_a at each corner
TETWARP_HD void add_piece(double volume, const double* const (&at)[4], VoxelShare& share) {
  double sum[4];
  for (int a = 0; a < 4; ++a) sum[a] = at[0][a] + at[1][a] + at[2][a] + at[3][a];
  int k = 0;
  for (int a = 0; a < 4; ++a) {
    for (int b = a; b < 4; ++b) {
      const double own =
          at[0][a] * at[0][b] + at[1][a] * at[1][b] + at[2][a] * at[2][b] + at[3][a] * at[3][b];
      share.product[k++] += volume * (1.0 / 20) * (own + sum[a] * sum[b]);
    }
  }
  share.volume += volume;
}

/// A whole box: the mean of the product of two linear functions is that of their values at the
/// center and 1/12 of the product of their slopes.
/// @param height  N_a at the center
TETWARP_HD void set_whole_share(const TetSetup& tet, const double* height, VoxelShare& share) {
  share.volume = 1;
  int k = 0;
  for (int a = 0; a < 4; ++a) {
    for (int b = a; b < 4; ++b) {
      const double slopes = tet.plane[0][a] * tet.plane[0][b] + tet.plane[1][a] * tet.plane[1][b] +
                            tet.plane[2][a] * tet.plane[2][b];
      share.product[k++] = height[a] * height[b] + slopes * (1.0 / 12);
    }
  }
}

/// The share of a tetrahedron in a voxel; exact but for rounding.
/// @param tet  plane a holds slope and value of N_a instead of a distance; the box is not used
/// @param x    the voxel
TETWARP_HD_RARE VoxelShare share_of(const TetSetup& tet, const int* x) {
  VoxelShare share;
  double height[4];
  const BoxPlace place = place_of_box(tet, x, height);
  if (place == BoxPlace::inside) set_whole_share(tet, height, share);
  if (place != BoxPlace::across) return share;
  ConvexPart memory[2];
  const ConvexPart* const part = part_in_tet(tet, height, memory[0], memory[1]);
  if (part == nullptr) return share;
  double at[max_corners][4];
  for (int c = 0; c < part->corner_count; ++c) {
    for (int a = 0; a < 4; ++a) {
      const double slope[3] = {tet.plane[0][a], tet.plane[1][a], tet.plane[2][a]};
      at[c][a] = height_over(slope, height[a], part->corner[c]);
    }
  }
  for_pieces(*part, [&](double volume6, int first, int from, int to) {
    add_piece(volume6 / 6, {at[0], at[first], at[from], at[to]}, share);
  });
  return share;
}

}  // namespace tetwarp

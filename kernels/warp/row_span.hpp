/// @file row_span.hpp
/// Stage "raster" of the warp on a device: the voxels of a row that lie within a tetrahedron, from
/// where the row crosses its faces. A row is eight voxels of a cell along i.
#pragma once
#include <cstdint>

#include "kernels/base/mul_add.hpp"
#include "kernels/warp/tet_setup.hpp"

namespace tetwarp {

/// The half of each row of a cell on the inner side of a face. Row (j, k) crosses the face at
/// i = at + along_j j + along_k k. Voxels farther from there than `margin` are certainly on their
/// side despite rounding.
struct alignas(16) RowBound {
  float at, along_j, along_k;
  float margin;  ///< positive: the inner side is that of larger i; negative: of smaller i
};

/// Bits i of the voxels of a row.
using RowBits = std::uint32_t;
constexpr RowBits whole_row = 0xff;

/// The bound of one face.
///
/// With u = 2^-24 and v the plane's distance from the cell's first voxel in voxels, a crossing is
/// wrong by at most u (4 |v| + 36) along the normal: three rounded inputs, two products with sums,
/// fused or not, and the sum with the margin. Steps along i below unit / 28 are replaced by it,
/// which moves the face by at most unit / 4 = u (2 |v| + 48) within a row. Together that is less
/// than the unit u (8 |v| + 192) of the margin.
/// @param corner  the cell's first voxel [frame]
/// @param is_cut  out, false where all voxels of the cell are certainly on the inner side
TETWARP_HD RowBound row_bound(const TetSetup& tet, int face, const int* corner, bool& is_cut) {
  const double normal[3] = {tet.plane[0][face], tet.plane[1][face], tet.plane[2][face]};
  double value = tet.plane[3][face], change = 0;
  for (int axis = 0; axis < 3; ++axis) {
    value += normal[axis] * static_cast<double>(corner[axis] - tet.anchor[axis]);
    change += min_of(normal[axis], 0.0);
  }
  const double unit = (fabs(value) + 24.0) * 0x1p-21;
  is_cut = !(value + change * (cell_edge - 1) > unit);
  const double least = unit * (1.0 / 28);
  const double step = fabs(normal[0]) < least ? copysign(least, normal[0]) : normal[0];
  const double per_step = 1.0 / step;
  return {static_cast<float>(-value * per_step), static_cast<float>(-normal[1] * per_step),
          static_cast<float>(-normal[2] * per_step), static_cast<float>(unit * per_step)};
}

/// The whole numbers of [low, high], within 0 to 7, as bits. Any values but NaN.
TETWARP_HD RowBits bits_between(float low, float high) {
  const float first = smaller_of(low, 8.0f), last = larger_of(high, -1.0f);
#if defined(__CUDA_ARCH__)  // the last bits of a sum with 1.5 x 2^23 are those of the whole number
  const std::uint32_t up = __float_as_uint(__fadd_ru(first, 0x1.8p23f));
  const std::uint32_t down = __float_as_uint(__fadd_rd(last, 0x1.8p23f));
  return (whole_row << (up & 31u)) & (whole_row >> ((7u - down) & 31u));
#else
  return (whole_row << static_cast<int>(ceil(first))) &
         (whole_row >> (7 - static_cast<int>(floor(last))));
#endif
}

/// The voxels of a row on the inner side of the faces seen so far.
struct RowSpan {
  float low = 0, high = cell_edge - 1;                    ///< certainly inside
  float possible_low = 0, possible_high = cell_edge - 1;  ///< certainly outside beyond

  TETWARP_HD void cut_below(const RowBound& bound, float j, float k) {
    const float at = crossing(bound, j, k);
    low = larger_of(low, at + bound.margin);
    possible_low = larger_of(possible_low, at - bound.margin);
  }
  TETWARP_HD void cut_above(const RowBound& bound, float j, float k) {
    const float at = crossing(bound, j, k);
    high = smaller_of(high, at + bound.margin);
    possible_high = smaller_of(possible_high, at - bound.margin);
  }
  TETWARP_HD RowBits inside() const { return bits_between(low, high); }
  TETWARP_HD RowBits possible() const { return bits_between(possible_low, possible_high); }

 private:
  TETWARP_HD static float crossing(const RowBound& bound, float j, float k) {
    return mul_add(bound.along_k, k, mul_add(bound.along_j, j, bound.at));
  }
};

}  // namespace tetwarp

/// @file tet_footprint.hpp
/// Bounds of the output voxels that a tetrahedron or hexahedron may own, and of the source voxels
/// that it reads for them.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "kernels/warp/hex_map.hpp"
#include "kernels/warp/tet_setup.hpp"

namespace tetwarp {

/// Bounds of one cell of the mesh. The source position of output voxel begin + (i, j, k) is
/// linear (i, j, k) + offset, unless `is_boxed`.
struct Footprint {
  int begin[3], end[3];  ///< output voxels it may own [frame voxel]
  int source_begin[3];   ///< source voxels around its positions, for all of its voxels
  int source_end[3];
  bool is_boxed;  ///< the map is not affine or too steep: only source_begin, source_end hold
  int spread[3];  ///< distance of an averaged sample from the position [source voxel]
  float linear[3][3];
  double offset[3];
};

/// A box of voxels: empty unless begin < end along every axis.
struct VoxelBox {
  std::int64_t begin[3], end[3];

  bool is_empty() const { return begin[0] >= end[0] || begin[1] >= end[1] || begin[2] >= end[2]; }
};

inline VoxelBox common(const VoxelBox& a, const VoxelBox& b) {
  VoxelBox box;
  for (int axis = 0; axis < 3; ++axis) {
    box.begin[axis] = std::max(a.begin[axis], b.begin[axis]);
    box.end[axis] = std::min(a.end[axis], b.end[axis]);
  }
  return box;
}

/// Extends `box` to contain `other`.
inline void enclose(VoxelBox& box, const VoxelBox& other) {
  if (other.is_empty()) return;
  for (int axis = 0; axis < 3; ++axis) {
    box.begin[axis] = std::min(box.begin[axis], other.begin[axis]);
    box.end[axis] = std::max(box.end[axis], other.end[axis]);
  }
}

/// The voxels around the image of the voxels of `box` under start + linear (i, j, k). One voxel
/// more on each side than exact arithmetic needs, for rounding.
template <class Real>
VoxelBox image_of(const VoxelBox& box, const Real (*linear)[3], const double* start) {
  VoxelBox image;
  for (int row = 0; row < 3; ++row) {
    double low = start[row], high = low;
    for (int axis = 0; axis < 3; ++axis) {
      const double slope = linear[row][axis];
      const double a = slope * static_cast<double>(box.begin[axis]);
      const double b = slope * static_cast<double>(box.end[axis] - 1);
      low += std::min(a, b);
      high += std::max(a, b);
    }
    image.begin[row] = static_cast<std::int64_t>(std::floor(std::max(low, -0x1p40))) - 1;
    image.end[row] = static_cast<std::int64_t>(std::floor(std::min(high, 0x1p40))) + 2;
  }
  return image;
}

inline int clamped_int(std::int64_t value) {
  constexpr std::int64_t far = std::int64_t{1} << 30;  // larger than any index of a grid
  return static_cast<int>(std::clamp(value, -far, far));
}

/// The footprint of a tetrahedron.
/// @param rest    its nodes in the index space of the source
/// @param spread  distance of an averaged sample from the position [output voxel]
inline Footprint footprint_of(const TetSetup& setup, const TetNodes& rest, double spread) {
  Footprint footprint;
  footprint.is_boxed = setup.kind == MapKind::steep;
  for (int row = 0; row < 3; ++row) {
    footprint.begin[row] = setup.begin[row];
    footprint.end[row] = setup.end[row];
    std::int64_t low = rest.x[0][row], high = low;
    double start = setup.map[3][row];
    for (int a = 1; a < 4; ++a) {
      low = std::min(low, rest.x[a][row]);
      high = std::max(high, rest.x[a][row]);
    }
    for (int axis = 0; axis < 3; ++axis) {
      const auto from = static_cast<double>(setup.begin[axis] - setup.anchor[axis]);
      start += setup.map[axis][row] * from;
      footprint.linear[row][axis] = static_cast<float>(setup.map[axis][row]);
    }
    footprint.offset[row] = start;
    double around = 0;
    for (int axis = 0; axis < 3; ++axis) around += spread * std::abs(setup.map[axis][row]);
    footprint.spread[row] =
        clamped_int(static_cast<std::int64_t>(std::ceil(min_of(around, 0x1p40))));
    footprint.source_begin[row] = clamped_int((low >> quantum_bits) - 1 - footprint.spread[row]);
    footprint.source_end[row] = clamped_int((high >> quantum_bits) + 2 + footprint.spread[row]);
  }
  return footprint;
}

/// The footprint of a hexahedron: its source box is that of the trilinear map of its corners, moved
/// outwards by hex_margin.
/// @param parts  footprints of its tets_per_hex tetrahedra; empty ones own nothing
/// @param rest   its corners in the index space of the source
inline Footprint footprint_of(const Footprint* parts, const HexCorners& rest) {
  Footprint all = parts[0];
  all.is_boxed = true;
  for (int axis = 0; axis < 3; ++axis) {
    all.begin[axis] = std::numeric_limits<int>::max();
    all.end[axis] = std::numeric_limits<int>::min();
  }
  for (int p = 0; p < tets_per_hex; ++p) {
    const Footprint& part = parts[p];
    for (int axis = 0; axis < 3; ++axis) {
      all.spread[axis] = std::max(all.spread[axis], part.spread[axis]);
      if (part.begin[0] >= part.end[0]) continue;
      all.begin[axis] = std::min(all.begin[axis], part.begin[axis]);
      all.end[axis] = std::max(all.end[axis], part.end[axis]);
    }
  }
  if (all.begin[0] >= all.end[0]) return Footprint{};
  const HexTerms terms = hex_terms(rest);
  double low[3] = {0x1p40, 0x1p40, 0x1p40}, high[3] = {-0x1p40, -0x1p40, -0x1p40};
  for (int a = 0; a < 8; ++a) {
    double u[3], x[3];
    Matrix3 gradient;
    for (int axis = 0; axis < 3; ++axis) {
      u[axis] = unit_corner(a, axis) != 0 ? 1 + hex_margin : -hex_margin;
    }
    map_hex(terms, u, x, gradient);
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], x[axis]);
      high[axis] = std::max(high[axis], x[axis]);
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    all.source_begin[axis] =
        clamped_int(static_cast<std::int64_t>(std::floor(low[axis])) - 1 - all.spread[axis]);
    all.source_end[axis] =
        clamped_int(static_cast<std::int64_t>(std::floor(high[axis])) + 2 + all.spread[axis]);
  }
  return all;
}

/// The source voxels around the positions that a cell of the mesh has for the voxels of `box`.
inline VoxelBox samples_of(const Footprint& footprint, const VoxelBox& box) {
  VoxelBox part, rest;
  for (int axis = 0; axis < 3; ++axis) {
    part.begin[axis] = std::max<std::int64_t>(box.begin[axis] - footprint.begin[axis], 0);
    part.end[axis] =
        std::min<std::int64_t>(box.end[axis], footprint.end[axis]) - footprint.begin[axis];
    rest.begin[axis] = footprint.source_begin[axis];
    rest.end[axis] = footprint.source_end[axis];
  }
  if (footprint.is_boxed) return rest;
  VoxelBox image = image_of(part, footprint.linear, footprint.offset);
  for (int axis = 0; axis < 3; ++axis) {
    image.begin[axis] -= footprint.spread[axis];
    image.end[axis] += footprint.spread[axis];
  }
  return common(rest, image);
}

/// Whether the cell may own voxels of `box`.
inline bool meets(const Footprint& footprint, const VoxelBox& box) {
  for (int axis = 0; axis < 3; ++axis) {
    if (footprint.begin[axis] >= box.end[axis] || footprint.end[axis] <= box.begin[axis]) {
      return false;
    }
  }
  return true;
}

/// Upper bound of the number of (tetrahedron, cell) pairs within `box`. @pre meets(footprint, box)
inline std::int64_t pairs_of(const Footprint& footprint, const VoxelBox& box) {
  std::int64_t pairs = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const auto begin = std::max<std::int64_t>(box.begin[axis], footprint.begin[axis]);
    const auto end = std::min<std::int64_t>(box.end[axis], footprint.end[axis]);
    pairs *= ((end - 1) >> cell_shift) - (begin >> cell_shift) + 1;
  }
  return pairs;
}

}  // namespace tetwarp

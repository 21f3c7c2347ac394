/// @file source_shares.hpp
/// Volumes of a convex body in the boxes of source voxels, from its faces alone.
///
/// By the divergence theorem, the part of a body at x in [a, a + 1] within a bar of voxels along x
/// has the volume of the integral of min(max(x - a, 0), 1) over its surface, dA the area projected
/// along x. Faces normal to y or z project to nothing, so that a body need not be closed where the
/// planes between bars cut it: polygons are cut instead of bodies.
#pragma once
#include <cstdint>

#include "kernels/base/hd.hpp"
#include "kernels/warp/volume_sample.hpp"

namespace tetwarp {

// A face of a box within a tetrahedron has at most nine corners; each of the six planes of a source
// voxel adds at most one.
constexpr int max_polygon_corners = 16;

/// A convex polygon, counterclockwise from outside of its body [source voxel].
struct Polygon {
  int count;
  double corner[max_polygon_corners][3];
};

TETWARP_HD void append_corner(Polygon& polygon, double x, double y, double z) {
  if (polygon.count == max_polygon_corners) return;
  double* const corner = polygon.corner[polygon.count++];
  corner[0] = x;
  corner[1] = y;
  corner[2] = z;
}

/// The corner at x[axis] = at of the edge between a corner below and one not below it.
TETWARP_HD void append_cut(const double* below,
                           const double* above,
                           int axis,
                           double at,
                           Polygon& first,
                           Polygon& second) {
  const double depth = at - below[axis];
  const double share = depth / (above[axis] - below[axis]);
  double cut[3];
  for (int a = 0; a < 3; ++a) cut[a] = below[a] + share * (above[a] - below[a]);
  cut[axis] = at;
  append_corner(first, cut[0], cut[1], cut[2]);
  append_corner(second, cut[0], cut[1], cut[2]);
}

/// Splits a polygon by a plane x[axis] = at. An edge is cut from its lower to its upper end, so
/// that both of its faces get the same corner.
TETWARP_HD void split_polygon(
    const Polygon& from, int axis, double at, Polygon& below, Polygon& above) {
  below.count = above.count = 0;
  int last = from.count - 1;
  bool was_below = from.corner[last][axis] < at;
  for (int c = 0; c < from.count; ++c) {
    const double* const now = from.corner[c];
    const bool is_below = now[axis] < at;
    if (is_below != was_below) {
      const double* const before = from.corner[last];
      append_cut(is_below ? now : before, is_below ? before : now, axis, at, below, above);
    }
    Polygon& side = is_below ? below : above;
    append_corner(side, now[0], now[1], now[2]);
    last = c;
    was_below = is_below;
  }
}

/// Position in the source of a point relative to the centre of a map's voxel, less map.whole.
TETWARP_HD void set_source_position(const SourceMap<double>& map, const double* x, double* at) {
  for (int row = 0; row < 3; ++row) {
    at[row] =
        map.base[row] + map.axis[0][row] * x[0] + map.axis[1][row] * x[1] + map.axis[2][row] * x[2];
  }
}

/// Signed volume in the source per volume in the output.
TETWARP_HD double map_volume(const SourceMap<double>& map) {
  const auto& a = map.axis;
  return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) +
         a[0][1] * (a[1][2] * a[2][0] - a[1][0] * a[2][2]) +
         a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
}

/// Source voxels whose boxes the box around a body intersects: first and last per axis.
struct VoxelRange {
  int first[3], last[3];
};

TETWARP_HD VoxelRange range_of(const double (*corner)[3], int count) {
  VoxelRange range;
  for (int axis = 0; axis < 3; ++axis) {
    double low = corner[0][axis], high = low;
    for (int c = 1; c < count; ++c) {
      low = min_of(low, corner[c][axis]);
      high = max_of(high, corner[c][axis]);
    }
    range.first[axis] = static_cast<int>(floor(low + 0.5));
    range.last[axis] = max_of(range.first[axis], static_cast<int>(ceil(high - 0.5)));
  }
  return range;
}

TETWARP_HD bool is_one(const VoxelRange& range) {
  return range.first[0] == range.last[0] && range.first[1] == range.last[1] &&
         range.first[2] == range.last[2];
}

/// Sums over the faces of a body in a block of source voxels. Voxels are counted from the block's
/// first one; i = size[0] stands for all behind the block.
struct SourceShares {
  static constexpr int edge = 5;  ///< most voxels of a block along each axis
  static constexpr int bars = edge * edge;

  int first[3];                      ///< first voxel of the block
  int size[3];                       ///< voxels along each axis, at most `edge`
  int low[bars], high[bars];         ///< per bar, first and last voxel that the body
                                     ///< intersects; none if low > high
  double within[bars][edge];         ///< integral over faces in the voxel
  double projected[bars][edge + 1];  ///< projected area of the faces in the voxel

  /// Begins with the block from voxel `begin` on, up to the voxels `end`.
  TETWARP_HD void set_block(const int (&begin)[3], const int* end) {
    for (int axis = 0; axis < 3; ++axis) {
      first[axis] = begin[axis];
      size[axis] = min_of(end[axis] - begin[axis], edge);
    }
    for (int bar = 0; bar < size[1] * size[2]; ++bar) {
      low[bar] = edge + 2;
      high[bar] = -2;
      for (int i = 0; i < size[0]; ++i) within[bar][i] = projected[bar][i] = 0;
      projected[bar][size[0]] = 0;
    }
  }

  /// Adds a face of the body.
  TETWARP_HD_RARE void add_face(const Polygon& face) {
    double area = 0;
    for (int c = 2; c < face.count; ++c) area += twice_area(face, c);
    if (fabs(area) < 0x1p-50) return;  // changes volumes by no more than rounding does
    double low_z, high_z;
    set_extent<2>(face, low_z, high_z);
    for_parts<2>(face, low_z, high_z, [&](int k, const Polygon& slab) {
      if (k < 0 || k >= size[2]) return;
      double low_y, high_y;
      set_extent<1>(slab, low_y, high_y);
      for_parts<1>(slab, low_y, high_y, [&](int j, const Polygon& strip) {
        if (j < 0 || j >= size[1]) return;
        const int bar = k * size[1] + j;
        add_strip(bar, strip);
      });
    });
  }

  /// Calls visit(voxel, volume) for voxels of the block that the body shares.
  /// @param sign  1; -1 if the faces are clockwise
  template <class Visit>
  TETWARP_HD void for_voxels(double sign, Visit&& visit) const {
    for (int k = 0; k < size[2]; ++k) {
      for (int j = 0; j < size[1]; ++j) {
        const int bar = k * size[1] + j;
        double behind = projected[bar][size[0]];
        for (int i = size[0] - 1; i >= low[bar] && i >= 0; --i) {
          const double volume = sign * (within[bar][i] + behind);
          behind += projected[bar][i];
          const int voxel[3] = {first[0] + i, first[1] + j, first[2] + k};
          if (volume > 0 && i <= high[bar]) visit(voxel, volume);
        }
      }
    }
  }

 private:
  /// Extent of a polygon along an axis, from the block's first voxel on: 0 is its lower side.
  template <int axis>
  TETWARP_HD void set_extent(const Polygon& polygon, double& low, double& high) const {
    low = high = polygon.corner[0][axis];
    for (int c = 1; c < polygon.count; ++c) {
      low = min_of(low, polygon.corner[c][axis]);
      high = max_of(high, polygon.corner[c][axis]);
    }
    low -= first[axis] - 0.5;
    high -= first[axis] - 0.5;
  }

  /// Calls work(n, part) for the parts of a polygon in the voxels n along an axis. n is -1 before
  /// the block and size[axis] behind it.
  template <int axis, class Work>
  TETWARP_HD void for_parts(const Polygon& polygon,
                            double lowest,
                            double highest,
                            Work&& work) const {
    const double start = first[axis] - 0.5;
    // Voxel n is [start + n, start + n + 1].
    int n = lowest < 0 ? -1 : static_cast<int>(min_of(lowest, static_cast<double>(size[axis])));
    if (n == size[axis] || highest <= n + 1) return work(n, polygon);
    Polygon parts[3];
    const Polygon* rest = &polygon;
    for (int next = 1; n < size[axis] && highest > n + 1; ++n, next = 3 - next) {
      split_polygon(*rest, axis, start + (n + 1), parts[0], parts[next]);
      if (parts[0].count > 2) work(n, parts[0]);
      rest = &parts[next];
    }
    if (rest->count > 2) work(n, *rest);
  }

  /// Adds the part of a face in a bar.
  TETWARP_HD void add_strip(int bar, const Polygon& strip) {
    double lowest, highest;
    set_extent<0>(strip, lowest, highest);
    const double end = size[0] + 1, from = max_of(min_of(lowest + 1, end), 0.0);
    const double to = max_of(min_of(highest + 1, end), 0.0);
    const int last = static_cast<int>(to);
    low[bar] = min_of(low[bar], static_cast<int>(from) - 1);
    high[bar] = max_of(high[bar], last < to ? last - 1 : last - 2);
    for_parts<0>(strip, lowest, highest,
                 [&](int i, const Polygon& piece) { add_piece(bar, i, piece); });
  }

  /// Twice the projected area of the triangle of corners 0, c - 1 and c.
  TETWARP_HD static double twice_area(const Polygon& polygon, int c) {
    const double *base = polygon.corner[0], *a = polygon.corner[c - 1], *b = polygon.corner[c];
    return (a[1] - base[1]) * (b[2] - base[2]) - (a[2] - base[2]) * (b[1] - base[1]);
  }

  TETWARP_HD void add_piece(int bar, int i, const Polygon& piece) {
    if (i < 0) return;
    const double from = first[0] - 0.5 + i;
    const double* const base = piece.corner[0];
    double area = 0, moment = 0;
    for (int c = 2; c < piece.count; ++c) {
      const double *a = piece.corner[c - 1], *b = piece.corner[c];
      const double twice = twice_area(piece, c);
      area += twice;
      moment += twice * ((base[0] - from) + (a[0] - from) + (b[0] - from));
    }
    projected[bar][i] += area / 2;
    if (i < size[0]) within[bar][i] += moment / 6;
  }
};

}  // namespace tetwarp

/// @file voxel_part.hpp
/// The part of a voxel's box within a tetrahedron: its faces, moved to the source.
///
/// The faces lie on the sides of the box, cut by the planes of the tetrahedron, and on these
/// planes, cut by the box and by one another. Each is computed alone, as a polygon of two
/// coordinates.
#pragma once
#include "kernels/warp/convex_part.hpp"
#include "kernels/warp/cut_square.hpp"
#include "kernels/warp/source_shares.hpp"

namespace tetwarp {

/// Source voxels whose boxes the box around a body intersects: first and last per axis.
struct VoxelRange {
  int first[3], last[3];
  double volume = 1;  ///< of the box around the body [source voxel]

  /// Sets an axis; indices that no source has are clamped.
  TETWARP_HD void set(int axis, double low, double high) {
    low = min_of(max_of(low, -max_whole), max_whole);
    high = min_of(max_of(high, -max_whole), max_whole);
    first[axis] = static_cast<int>(floor(low));
    last[axis] = max_of(first[axis], static_cast<int>(ceil(high)) - 1);
    volume *= high - low;
  }
};

/// The range of a voxel's box, relative to map.whole.
/// @param map  of a tetrahedron; (0, 0, 0) is the voxel
TETWARP_HD VoxelRange range_of_box(const SourceMap<double>& map) {
  VoxelRange range;
  for (int row = 0; row < 3; ++row) {
    const double reach =
        0.5 * (fabs(map.axis[0][row]) + fabs(map.axis[1][row]) + fabs(map.axis[2][row]));
    const double centre = map.base[row] + 0.5;
    range.set(row, centre - reach, centre + reach);
  }
  return range;
}

/// The faces of the part of a voxel's box within a tetrahedron.
class VoxelPart {
 public:
  /// Positions are relative to map.whole.
  /// @param height    from place_of_box()
  /// @param is_whole  whether the box is within the tetrahedron
  /// @param map       of the tetrahedron; (0, 0, 0) is the voxel
  TETWARP_HD VoxelPart(const TetSetup& tet,
                       const double* height,
                       bool is_whole,
                       const SourceMap<double>& map)
      : count_(0) {
    int cuts = 0;
    for (int face = 0; face < 4 && !is_whole; ++face) {
      if (height[face] - box_reach(tet, face) < 0) cuts |= 1 << face;
    }
    const Place place = {tet, height, map, map_volume(map) < 0 ? -1.0 : 1.0, cuts};
    for (int axis = 0; axis < 3; ++axis) add_box_sides(place, axis);
    for (int face = 0; face < 4; ++face) {
      if ((cuts >> face & 1) != 0) add_tet_face(place, face);
    }
    if (cuts == 0) {
      range_ = range_of_box(map);
    } else {
      for (int axis = 0; axis < 3; ++axis) set_range(axis);
    }
  }

  TETWARP_HD int count() const { return count_; }  ///< of faces that are not empty
  TETWARP_HD const SourceFace& face(int f) const { return faces_[f]; }
  TETWARP_HD const VoxelRange& range() const { return range_; }

 private:
  struct Place {
    const TetSetup& tet;
    const double* height;
    const SourceMap<double>& map;
    double sign;  ///< of the volume of the map
    int cuts;     ///< bit f: the plane of face f cuts the box
  };
  /// Positions origin + u side[0] + v side[1] in the source.
  struct Plane {
    double origin[3], side[2][3];
  };

  /// The two sides of the box that are normal to an axis of the output.
  TETWARP_HD void add_box_sides(const Place& place, int axis) {
    const int u = axis == 2 ? 0 : axis + 1, v = axis == 0 ? 2 : axis - 1;
    const auto& plane = place.tet.plane;
    Plane side;
    for (int row = 0; row < 3; ++row) {
      side.side[0][row] = place.map.axis[u][row];
      side.side[1][row] = place.map.axis[v][row];
    }
    for (int upper = 0; upper < 2; ++upper) {
      const double from_centre = upper - 0.5;
      CutSquare square;
      square.set_whole();
      bool is_empty = false;
      for (int face = 0; face < 4 && !is_empty; ++face) {
        if ((place.cuts >> face & 1) == 0) continue;
        is_empty = !square.cut({place.height[face] + from_centre * plane[axis][face],
                                {plane[u][face], plane[v][face]}});
      }
      if (is_empty) continue;
      for (int row = 0; row < 3; ++row) {
        side.origin[row] = (place.map.base[row] + 0.5) + from_centre * place.map.axis[axis][row];
      }
      add_face(square, side, upper != 0 ? place.sign : -place.sign);
    }
  }

  /// The face of the part in a plane of the tetrahedron, by the two output coordinates along which
  /// the plane extends most.
  TETWARP_HD_RARE void add_tet_face(const Place& place, int face) {
    const auto& plane = place.tet.plane;
    int axis = 0;
    for (int a = 1; a < 3; ++a) {
      if (fabs(plane[a][face]) > fabs(plane[axis][face])) axis = a;
    }
    const int u = axis == 2 ? 0 : axis + 1, v = axis == 0 ? 2 : axis - 1;
    const double per_height = 1 / plane[axis][face];
    const HalfPlane across = {// the coordinate along `axis`
                              -place.height[face] * per_height,
                              {-plane[u][face] * per_height, -plane[v][face] * per_height}};
    CutSquare square;
    square.set_whole();
    if (!square.cut({0.5 + across.offset, {across.slope[0], across.slope[1]}})) return;
    if (!square.cut({0.5 - across.offset, {-across.slope[0], -across.slope[1]}})) return;
    for (int other = 0; other < 4; ++other) {
      if (other == face || (place.cuts >> other & 1) == 0) continue;
      const double along = plane[axis][other];
      if (!square.cut({place.height[other] + along * across.offset,
                       {plane[u][other] + along * across.slope[0],
                        plane[v][other] + along * across.slope[1]}})) {
        return;
      }
    }
    Plane side;
    const auto& map = place.map;
    for (int row = 0; row < 3; ++row) {
      side.origin[row] = (map.base[row] + 0.5) + across.offset * map.axis[axis][row];
      side.side[0][row] = map.axis[u][row] + across.slope[0] * map.axis[axis][row];
      side.side[1][row] = map.axis[v][row] + across.slope[1] * map.axis[axis][row];
    }
    add_face(square, side, plane[axis][face] > 0 ? -place.sign : place.sign);
  }

  TETWARP_HD void add_face(const CutSquare& square, const Plane& plane, double sign) {
    SourceFace& face = faces_[count_++];
    face.count = square.count;
    face.sign = sign;
    set_cross(plane.side[0], plane.side[1], face.normal);
    for (int c = 0; c < square.count; ++c) {
      for (int row = 0; row < 3; ++row) {
        face.corner[c][row] = plane.origin[row] + square.corner[c][0] * plane.side[0][row] +
                              square.corner[c][1] * plane.side[1][row];
      }
    }
  }

  TETWARP_HD void set_range(int axis) {
    double low = 0, high = 0;
    if (count_ > 0) low = high = faces_[0].corner[0][axis];
    for (int f = 0; f < count_; ++f) {
      for (int c = 0; c < faces_[f].count; ++c) {
        low = min_of(low, faces_[f].corner[c][axis]);
        high = max_of(high, faces_[f].corner[c][axis]);
      }
    }
    range_.set(axis, low, high);
  }

  static constexpr int max_count = 10;  ///< six sides of the box and four faces of the tetrahedron
  int count_;
  SourceFace faces_[max_count];
  VoxelRange range_;
};

}  // namespace tetwarp

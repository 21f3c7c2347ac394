/// @file voxel_part.hpp
/// The part of a voxel's box within a tetrahedron: its faces, moved to the source.
///
/// The faces lie on the sides of the box, cut by the planes of the tetrahedron, and on these
/// planes, cut by the box and by one another. Each is computed alone, as a polygon of two
/// coordinates.
#pragma once
#include "kernels/warp/overlap/convex_part.hpp"
#include "kernels/warp/overlap/cut_square.hpp"
#include "kernels/warp/sample/source_shares.hpp"

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
    const double center = map.base[row] + 0.5;
    range.set(row, center - reach, center + reach);
  }
  return range;
}

/// Most faces of a part: six sides of the box and four faces of the tetrahedron.
constexpr int max_part_faces = 10;

/// The faces of the part of a voxel's box within a tetrahedron, one by one. Positions are relative
/// to map.whole.
struct PartFaces {
  const TetSetup& tet;
  const double* height;          ///< from place_of_box()
  const SourceMap<double>& map;  ///< of the tetrahedron; (0, 0, 0) is the voxel
  double weight;                 ///< of the body; its sign is that of the volume of the map
  int cuts;                      ///< bit f: the plane of face f cuts the box
  int left_out = 0;              ///< bit f: the face in this plane is not one of them

  /// Sets a face: one of the six sides of the box, or the plane of face n - 6.
  /// @param n  0 to max_part_faces - 1
  /// @returns false, and nothing of use is set, if the face is empty
  TETWARP_HD bool set_face(int n, SourceFace& face) const {
    return n < 6 ? set_box_side(n >> 1, n & 1, face)
                 : ((cuts & ~left_out) >> (n - 6) & 1) != 0 && set_tet_face(n - 6, face);
  }

 private:
  /// Positions origin + u side[0] + v side[1] in the source.
  struct Plane {
    double origin[3], side[2][3];
  };

  /// One of the two sides of the box that are normal to an axis of the output.
  TETWARP_HD bool set_box_side(int axis, int upper, SourceFace& face) const {
    const int u = axis == 2 ? 0 : axis + 1, v = axis == 0 ? 2 : axis - 1;
    const double from_center = upper - 0.5;
    CutSquare square;
    square.set_whole();
    for (int f = 0; f < 4; ++f) {
      if ((cuts >> f & 1) == 0) continue;
      if (!square.cut(
              {height[f] + from_center * tet.plane[axis][f], {tet.plane[u][f], tet.plane[v][f]}})) {
        return false;
      }
    }
    Plane side;
    for (int row = 0; row < 3; ++row) {
      side.side[0][row] = map.axis[u][row];
      side.side[1][row] = map.axis[v][row];
      side.origin[row] = (map.base[row] + 0.5) + from_center * map.axis[axis][row];
    }
    set_polygon(square, side, upper != 0 ? weight : -weight, face);
    return true;
  }

  /// The face of the part in a plane of the tetrahedron, by the two output coordinates along which
  /// the plane extends most.
  TETWARP_HD_RARE bool set_tet_face(int cut, SourceFace& face) const {
    const auto& plane = tet.plane;
    int axis = 0;
    for (int a = 1; a < 3; ++a) {
      if (fabs(plane[a][cut]) > fabs(plane[axis][cut])) axis = a;
    }
    const int u = axis == 2 ? 0 : axis + 1, v = axis == 0 ? 2 : axis - 1;
    const double per_height = 1 / plane[axis][cut];
    const HalfPlane across = {// the coordinate along `axis`
                              -height[cut] * per_height,
                              {-plane[u][cut] * per_height, -plane[v][cut] * per_height}};
    CutSquare square;
    square.set_whole();
    if (!square.cut({0.5 + across.offset, {across.slope[0], across.slope[1]}})) return false;
    if (!square.cut({0.5 - across.offset, {-across.slope[0], -across.slope[1]}})) return false;
    for (int other = 0; other < 4; ++other) {
      if (other == cut || (cuts >> other & 1) == 0) continue;
      const double along = plane[axis][other];
      if (!square.cut({height[other] + along * across.offset,
                       {plane[u][other] + along * across.slope[0],
                        plane[v][other] + along * across.slope[1]}})) {
        return false;
      }
    }
    Plane side;
    for (int row = 0; row < 3; ++row) {
      side.origin[row] = (map.base[row] + 0.5) + across.offset * map.axis[axis][row];
      side.side[0][row] = map.axis[u][row] + across.slope[0] * map.axis[axis][row];
      side.side[1][row] = map.axis[v][row] + across.slope[1] * map.axis[axis][row];
    }
    set_polygon(square, side, plane[axis][cut] > 0 ? -weight : weight, face);
    return true;
  }

  TETWARP_HD static void set_polygon(const CutSquare& square,
                                     const Plane& plane,
                                     double weight,
                                     SourceFace& face) {
    face.count = square.count;
    face.weight = weight;
    set_cross(plane.side[0], plane.side[1], face.normal);
    for (int c = 0; c < square.count; ++c) {
      for (int row = 0; row < 3; ++row) {
        face.corner[c][row] = plane.origin[row] + square.corner[c][0] * plane.side[0][row] +
                              square.corner[c][1] * plane.side[1][row];
      }
    }
  }
};

/// The faces whose planes cut a voxel's box, as bits.
/// @param height  from place_of_box()
TETWARP_HD int cuts_of(const TetSetup& tet, const double* height) {
  int cuts = 0;
  for (int face = 0; face < 4; ++face) {
    if (height[face] - box_reach(tet, face) < 0) cuts |= 1 << face;
  }
  return cuts;
}

/// All faces of the part of a voxel's box within a tetrahedron, and the range around them.
class VoxelPart {
 public:
  TETWARP_HD explicit VoxelPart(const PartFaces& faces) : count_(0) {
    for (int n = 0; n < max_part_faces; ++n) {
      if (faces.set_face(n, faces_[count_])) ++count_;
    }
    if (faces.cuts == 0) {
      range_ = range_of_box(faces.map);
    } else {
      for (int axis = 0; axis < 3; ++axis) set_range(axis);
    }
  }

  TETWARP_HD int count() const { return count_; }  ///< of faces that are not empty
  TETWARP_HD const SourceFace& face(int f) const { return faces_[f]; }
  TETWARP_HD const VoxelRange& range() const { return range_; }

 private:
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

  int count_;
  SourceFace faces_[max_part_faces];
  VoxelRange range_;
};

}  // namespace tetwarp

/// @file convex_part.hpp
/// The part of a voxel's box within half-spaces, and its volume.
///
/// A part is an unordered list of directed edges, each with the face that it bounds. Where a plane
/// cuts a face, one new edge closes the remaining part, and the reversed edge belongs to the face
/// that the plane adds. The volume is a sum over edges, so their order does not matter.
#pragma once
#include <cstdint>

#include "kernels/base/hd.hpp"
#include "kernels/warp/tet_setup.hpp"

namespace tetwarp {

// A box cut by the four planes of a tetrahedron and two planes per axis of the source has at most
// 16 faces; as three edges meet in a corner, at most 28 corners and 84 directed edges.
constexpr int max_faces = 16;
constexpr int max_corners = 32;
constexpr int max_edges = 96;

/// A convex body. Positions relative to the center of a voxel [voxel].
struct ConvexPart {
  int corner_count;
  int edge_count;
  int face_count;
  double corner[max_corners][3];
  std::uint8_t edge[max_edges][3];  ///< from and to, counterclockwise from outside; the face
};

TETWARP_HD void add_edge(ConvexPart& part, int from, int to, int face) {
  if (part.edge_count == max_edges) return;
  std::uint8_t* const edge = part.edge[part.edge_count++];
  edge[0] = static_cast<std::uint8_t>(from);
  edge[1] = static_cast<std::uint8_t>(to);
  edge[2] = static_cast<std::uint8_t>(face);
}

TETWARP_HD int add_corner(ConvexPart& part, const double* x) {
  if (part.corner_count == max_corners) return max_corners - 1;
  for (int axis = 0; axis < 3; ++axis) part.corner[part.corner_count][axis] = x[axis];
  return part.corner_count++;
}

/// The faces of a box; bit `axis` of a corner is set on the upper side.
struct BoxFaces {
  std::uint8_t loop[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                             {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
};

/// Half the extent of a voxel's box along the normal of a tetrahedron's face [voxel].
TETWARP_HD double box_reach(const TetSetup& tet, int face) {
  return 0.5 * (fabs(tet.plane[0][face]) + fabs(tet.plane[1][face]) + fabs(tet.plane[2][face]));
}

/// The box of a voxel.
TETWARP_HD void set_box_part(ConvexPart& part) {
  const BoxFaces faces;
  part.corner_count = 8;
  part.edge_count = 0;
  part.face_count = 6;
  for (int c = 0; c < 8; ++c) {
    for (int axis = 0; axis < 3; ++axis) part.corner[c][axis] = (c >> axis & 1) - 0.5;
  }
  for (int face = 0; face < 6; ++face) {
    for (int e = 0; e < 4; ++e)
      add_edge(part, faces.loop[face][e], faces.loop[face][(e + 1) % 4], face);
  }
}

/// Appends (corner, face) to a list of at most max_corners.
TETWARP_HD void append_corner(std::uint8_t (*list)[2], int& count, int corner, int face) {
  if (count == max_corners) return;
  list[count][0] = static_cast<std::uint8_t>(corner);
  list[count++][1] = static_cast<std::uint8_t>(face);
}

/// normal . x + offset: one function, so that all comparisons have the same rounding.
TETWARP_HD double height_over(const double* normal, double offset, const double* x) {
  return normal[0] * x[0] + normal[1] * x[1] + normal[2] * x[2] + offset;
}

/// Cuts a body to the half-space normal . x + offset >= 0.
/// @param to  out, the part
/// @returns false if the part is empty or flat
TETWARP_HD_RARE bool clip_part(const ConvexPart& from,
                               const double* normal,
                               double offset,
                               ConvexPart& to) {
  double height[max_corners];
  std::uint8_t place[max_corners];
  bool has_above = false;
  to.corner_count = to.edge_count = 0;
  to.face_count = from.face_count;
  for (int c = 0; c < from.corner_count; ++c) {
    height[c] = height_over(normal, offset, from.corner[c]);
    has_above = has_above || height[c] > 0;
    if (height[c] >= 0) place[c] = static_cast<std::uint8_t>(add_corner(to, from.corner[c]));
  }
  if (!has_above) return false;
  const int kept = to.corner_count;
  std::uint8_t cut_edge[max_corners][2];  // of corners from `kept` on: ends above and below
  const auto cut_between = [&](int above, int below) {
    for (int c = kept; c < to.corner_count; ++c) {
      if (cut_edge[c][0] == above && cut_edge[c][1] == below) return c;
    }
    const double share = height[above] / (height[above] - height[below]);
    double x[3];
    for (int axis = 0; axis < 3; ++axis) {
      const double start = from.corner[above][axis];
      x[axis] = start + share * (from.corner[below][axis] - start);
    }
    const int c = add_corner(to, x);
    cut_edge[c][0] = static_cast<std::uint8_t>(above);
    cut_edge[c][1] = static_cast<std::uint8_t>(below);
    return c;
  };
  // Cut corners at which the boundary of a face leaves the half-space and enters it again: one of
  // each per face, or several due to rounding if the face is in the plane. Then any pairing closes
  // the face; the difference in volume is of the order of rounding.
  std::uint8_t leaves[max_corners][2], enters[max_corners][2];  // corner, face
  int leave_count = 0, enter_count = 0;
  for (int e = 0; e < from.edge_count; ++e) {
    const int a = from.edge[e][0], b = from.edge[e][1], face = from.edge[e][2];
    if (height[a] >= 0 && height[b] >= 0) {
      add_edge(to, place[a], place[b], face);
    } else if (height[a] >= 0) {
      const int cut = cut_between(a, b);
      add_edge(to, place[a], cut, face);
      append_corner(leaves, leave_count, cut, face);
    } else if (height[b] >= 0) {
      const int cut = cut_between(b, a);
      add_edge(to, cut, place[b], face);
      append_corner(enters, enter_count, cut, face);
    }
  }
  for (int l = 0; l < leave_count; ++l) {
    int e = 0;
    while (e < enter_count && enters[e][1] != leaves[l][1]) ++e;
    if (e == enter_count) continue;
    add_edge(to, leaves[l][0], enters[e][0], leaves[l][1]);
    add_edge(to, enters[e][0], leaves[l][0], from.face_count);
    enters[e][1] = max_faces;  // taken
  }
  to.face_count = from.face_count + 1;
  return true;
}

/// Calls visit(six times the volume, corner, corner, corner) for tetrahedra that fill a body: of
/// every edge, the body's first corner and one corner of the edge's face. Those of rounding may be
/// negative.
template <class Visit>
TETWARP_HD void for_pieces(const ConvexPart& part, Visit&& visit) {
  const double* const apex = part.corner[0];
  int base[max_faces];
  for (int face = 0; face < max_faces; ++face) base[face] = -1;
  for (int e = 0; e < part.edge_count; ++e) {
    int& first = base[part.edge[e][2]];
    if (first < 0) first = part.edge[e][0];
    double side[3][3];
    for (int axis = 0; axis < 3; ++axis) {
      side[0][axis] = part.corner[first][axis] - apex[axis];
      side[1][axis] = part.corner[part.edge[e][0]][axis] - apex[axis];
      side[2][axis] = part.corner[part.edge[e][1]][axis] - apex[axis];
    }
    visit(side[0][0] * (side[1][1] * side[2][2] - side[1][2] * side[2][1]) +
              side[0][1] * (side[1][2] * side[2][0] - side[1][0] * side[2][2]) +
              side[0][2] * (side[1][0] * side[2][1] - side[1][1] * side[2][0]),
          first, part.edge[e][0], part.edge[e][1]);
  }
}

/// Volume [voxel^3].
TETWARP_HD_RARE double volume_of(const ConvexPart& part) {
  double volume6 = 0;
  for_pieces(part, [&](double piece6, int, int, int) { volume6 += piece6; });
  return volume6 / 6;
}

/// Where the box of a voxel is, in relation to a tetrahedron. Boxes that touch it in a point or a
/// face only may count as any.
enum class BoxPlace { outside, inside, across };

/// @param x       the voxel [frame]
/// @param height  out, distance of its center from the planes of the faces, positive inside
TETWARP_HD BoxPlace place_of_box(const TetSetup& tet, const int* x, double* height) {
  const double from[3] = {static_cast<double>(x[0] - tet.anchor[0]),
                          static_cast<double>(x[1] - tet.anchor[1]),
                          static_cast<double>(x[2] - tet.anchor[2])};
  BoxPlace place = BoxPlace::inside;
  for (int face = 0; face < 4; ++face) {
    height[face] = tet.plane[0][face] * from[0] + tet.plane[1][face] * from[1] +
                   tet.plane[2][face] * from[2] + tet.plane[3][face];
    const double reach = box_reach(tet, face);
    if (height[face] + reach <= 0) return BoxPlace::outside;
    if (height[face] - reach < 0) place = BoxPlace::across;
  }
  return place;
}

/// The part of the box of a voxel that lies in a tetrahedron.
/// @param height       from place_of_box()
/// @param part, other  memory for the result and scratch
/// @returns the one of them that holds the result; null if the part is empty
TETWARP_HD_RARE const ConvexPart* part_in_tet(const TetSetup& tet,
                                              const double* height,
                                              ConvexPart& part,
                                              ConvexPart& other) {
  set_box_part(part);
  ConvexPart *now = &part, *next = &other;
  for (int face = 0; face < 4; ++face) {
    if (height[face] - box_reach(tet, face) >= 0) continue;
    const double normal[3] = {tet.plane[0][face], tet.plane[1][face], tet.plane[2][face]};
    if (!clip_part(*now, normal, height[face], *next)) return nullptr;
    ConvexPart* const last = now;
    now = next;
    next = last;
  }
  return now;
}

}  // namespace tetwarp

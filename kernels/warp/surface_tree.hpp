/// @file surface_tree.hpp
/// The surface of a deformed mesh in a tree of boxes, and the nearest point on it.
#pragma once
#include <cstdint>

#include "kernels/base/hd.hpp"
#include "kernels/base/view.hpp"
#include "kernels/warp/node_quantize.hpp"

namespace tetwarp {

/// A node of the surface.
struct SurfaceNode {
  double at[3];       ///< deformed position from the output's first voxel [world]
  double to_rest[3];  ///< rest minus deformed position [world]
};

struct SurfaceBox {
  double low[3], high[3];
};

/// A complete binary tree of boxes: node h has the children 2 h and 2 h + 1, the root is 1, and the
/// second half of the boxes are leaves. Leaf l holds the triangles from count l / leaves on.
struct SurfaceTree {
  View<const SurfaceNode> nodes;
  View<const std::int32_t> triangles;  ///< three nodes each, in the order of the leaves
  View<const SurfaceBox> boxes;        ///< twice as many as leaves; the first is not used

  TETWARP_HD std::int64_t leaves() const { return boxes.size / 2; }
  TETWARP_HD std::int64_t first_triangle(std::int64_t leaf) const {
    return triangles.size / 3 * leaf / leaves();
  }
};

/// The nearest point so far.
struct NearestSurfacePoint {
  double distance2;       ///< square of the distance
  std::int64_t triangle;  ///< -1: none
  double to_rest[3];      ///< rest minus deformed position, linear in the triangle [world]
};

TETWARP_HD double dot_product(const double* a, const double* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// A triangle beside a position.
struct TriangleBeside {
  const SurfaceNode* corners[3];
  double from_x[3];           ///< from the position to the first corner
  double side1[3], side2[3];  ///< from there to the others

  /// Takes the point with these weights of the second and third corner if it is nearer; of equally
  /// near ones that of the lower triangle.
  TETWARP_HD void take_nearer(double w1,
                              double w2,
                              std::int64_t triangle,
                              NearestSurfacePoint& nearest) const {
    double apart[3];
    for (int axis = 0; axis < 3; ++axis) {
      apart[axis] = from_x[axis] + (w1 * side1[axis] + w2 * side2[axis]);
    }
    const double distance2 = dot_product(apart, apart);
    const bool is_nearer = distance2 < nearest.distance2 ||
                           (distance2 == nearest.distance2 && triangle < nearest.triangle);
    if (!is_nearer) return;
    nearest.distance2 = distance2;
    nearest.triangle = triangle;
    for (int axis = 0; axis < 3; ++axis) {
      const double a = corners[0]->to_rest[axis];
      nearest.to_rest[axis] =
          a + (w1 * (corners[1]->to_rest[axis] - a) + w2 * (corners[2]->to_rest[axis] - a));
    }
  }
};

/// The parameter of the point of a segment that is nearest to x; of a segment without length 0.
/// @param along    product of the segment and the way from its beginning to x
/// @param length2  square of its length
TETWARP_HD double nearest_along(double along, double length2) {
  return min_of(max_of(length2 > 0 ? along / length2 : 0, 0.0), 1.0);
}

/// The nearest point of a triangle: of its edges, or within it. The edges are always tried, since
/// the weights within a thin triangle are inaccurate; any weights are those of one of its points.
TETWARP_HD_RARE void take_triangle(const SurfaceTree& tree,
                                   std::int64_t triangle,
                                   const double* x,
                                   NearestSurfacePoint& nearest) {
  TriangleBeside t;
  for (int c = 0; c < 3; ++c) t.corners[c] = &tree.nodes[tree.triangles[3 * triangle + c]];
  const double *a = t.corners[0]->at, *b = t.corners[1]->at, *c = t.corners[2]->at;
  double side3[3], p[3], q[3];  // from the second to the third corner, and from both to x
  for (int axis = 0; axis < 3; ++axis) {
    t.from_x[axis] = a[axis] - x[axis];
    t.side1[axis] = b[axis] - a[axis];
    t.side2[axis] = c[axis] - a[axis];
    side3[axis] = c[axis] - b[axis];
    p[axis] = x[axis] - a[axis];
    q[axis] = x[axis] - b[axis];
  }
  const double g11 = dot_product(t.side1, t.side1), g12 = dot_product(t.side1, t.side2);
  const double g22 = dot_product(t.side2, t.side2), area2 = g11 * g22 - g12 * g12;
  const double p1 = dot_product(t.side1, p), p2 = dot_product(t.side2, p);
  const double on3 = nearest_along(dot_product(side3, q), dot_product(side3, side3));
  t.take_nearer(nearest_along(p1, g11), 0, triangle, nearest);
  t.take_nearer(0, nearest_along(p2, g22), triangle, nearest);
  t.take_nearer(1 - on3, on3, triangle, nearest);
  const double w1 = (g22 * p1 - g12 * p2) / area2, w2 = (g11 * p2 - g12 * p1) / area2;
  // False for NaN, too.
  if (w1 >= 0 && w2 >= 0 && w1 + w2 <= 1) t.take_nearer(w1, w2, triangle, nearest);
}

/// Square of the distance to a box; 0 inside.
TETWARP_HD double box_distance2(const SurfaceBox& box, const double* x) {
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double apart = max_of(max_of(box.low[axis] - x[axis], x[axis] - box.high[axis]), 0.0);
    sum += apart * apart;
  }
  return sum;
}

/// An error of distances between a position and triangles, due to rounding [world].
TETWARP_HD double distance_rounding(const SurfaceTree& tree, const double* x) {
  const SurfaceBox& all = tree.boxes[1];
  double size = 0;
  for (int axis = 0; axis < 3; ++axis) {
    size += fabs(x[axis]) + max_of(fabs(all.low[axis]), fabs(all.high[axis]));
  }
  return 1e-14 * size;
}

/// Calls visit(leaf) for the leaves whose boxes are at most as far from x as is_near(node) allows,
/// until visit returns false.
///
/// Goes down to the nearer child first; the bits of `trail` tell on which levels the other one has
/// been visited. Source: A. Áfra and L. Szirmay-Kalos, "Stackless multi-BVH traversal for CPU, MIC
/// and GPU ray tracing", 2014.
template <class IsNear, class Visit>
TETWARP_HD void visit_leaves(const SurfaceTree& tree,
                             const double* x,
                             const IsNear& is_near,
                             const Visit& visit) {
  const std::int64_t leaves = tree.leaves();
  std::uint64_t trail = 0;
  for (std::int64_t node = 1;;) {
    if (is_near(node)) {
      if (node < leaves) {
        const std::int64_t child = 2 * node;
        const bool second =
            box_distance2(tree.boxes[child + 1], x) < box_distance2(tree.boxes[child], x);
        node = child + (second ? 1 : 0);
        trail <<= 1;
        continue;
      }
      if (!visit(node - leaves)) return;
    }
    while ((trail & 1) != 0) {
      trail >>= 1;
      node >>= 1;
    }
    if (node == 1) return;
    node ^= 1;
    trail |= 1;
  }
}

/// The nearest point of the surface, where it is nearer than `nearest`; of equally near triangles
/// the one of the lowest number. So the result does not depend on where the search begins.
TETWARP_HD_RARE void find_nearest(const SurfaceTree& tree,
                                  const double* x,
                                  NearestSurfacePoint& nearest) {
  const double rounding = distance_rounding(tree, x);
  double limit2 = square_of(sqrt(nearest.distance2) + rounding);
  visit_leaves(
      tree, x, [&](std::int64_t node) { return box_distance2(tree.boxes[node], x) <= limit2; },
      [&](std::int64_t leaf) {
        const std::int64_t past = tree.first_triangle(leaf + 1);
        for (std::int64_t t = tree.first_triangle(leaf); t < past; ++t) {
          take_triangle(tree, t, x, nearest);
        }
        limit2 = square_of(sqrt(nearest.distance2) + rounding);
        return true;
      });
}

/// One index = one node of the surface; any order.
struct SurfaceNodeOp {
  View<const Node> nodes;           ///< of the mesh [quantum, frame]
  View<const std::int32_t> number;  ///< of the surface's nodes in the mesh
  View<const double> rest;          ///< three per node, from the output's first voxel [world]
  double to_world[3][3];            ///< axes of the output [world per voxel]
  std::int64_t frame[3];            ///< index of frame voxel (0, 0, 0) in the output grid
  View<SurfaceNode> surface;        ///< out

  TETWARP_HD void operator()(std::int64_t n) const {
    const Node& node = nodes[number[n]];
    double index[3];
    for (int axis = 0; axis < 3; ++axis) {
      index[axis] = static_cast<double>(node.x[axis] + frame[axis] * quanta_per_voxel) /
                    static_cast<double>(quanta_per_voxel);
    }
    SurfaceNode& out = surface[n];
    for (int row = 0; row < 3; ++row) {
      out.at[row] = dot_product(to_world[row], index);
      out.to_rest[row] = rest[3 * n + row] - out.at[row];
    }
  }
};

/// One index = one box of a level of the tree; any order, after the level below.
struct SurfaceBoxOp {
  SurfaceTree tree;
  View<SurfaceBox> boxes;  ///< out: those of `tree`
  std::int64_t first;      ///< box of the level: its number of boxes

  TETWARP_HD void operator()(std::int64_t n) const {
    const std::int64_t node = first + n, leaf = node - tree.leaves();
    SurfaceBox box;
    for (int axis = 0; axis < 3; ++axis) {
      if (leaf < 0) {
        const SurfaceBox &low = boxes[2 * node], &high = boxes[2 * node + 1];
        box.low[axis] = min_of(low.low[axis], high.low[axis]);
        box.high[axis] = max_of(low.high[axis], high.high[axis]);
        continue;
      }
      const std::int64_t begin = 3 * tree.first_triangle(leaf);
      const std::int64_t past = 3 * tree.first_triangle(leaf + 1);
      box.low[axis] = box.high[axis] = tree.nodes[tree.triangles[begin]].at[axis];
      for (std::int64_t c = begin + 1; c < past; ++c) {
        const double at = tree.nodes[tree.triangles[c]].at[axis];
        box.low[axis] = min_of(box.low[axis], at);
        box.high[axis] = max_of(box.high[axis], at);
      }
    }
    boxes[node] = box;
  }
};

}  // namespace tetwarp

/// @file surface_near.hpp
/// The few triangles of a surface among which the nearest ones of all positions in a ball are.
#pragma once
#include <cstdint>

#include "kernels/base/hd.hpp"
#include "kernels/warp/surface_tree.hpp"

namespace tetwarp {

/// Distances to a triangle by products with its axes: one across it, and for each of its sides one
/// along that and one outwards within the triangle. Accurate to 1e-10 of the size of the surface.
struct TriangleAxes {
  double across[3], outward[3][3], along[3][3];  ///< unit vectors; zero: the triangle is too thin
  double height, beyond[3], from_corner[3];      ///< the products of the ball's center [world]
  double length[3];                              ///< of the sides

  /// @param corners  from the ball's center
  TETWARP_HD static TriangleAxes of(const double (*corners)[3]) {
    TriangleAxes axes = {};
    double sides[3][3], normal[3], longest2 = 0;
    for (int side = 0; side < 3; ++side) {
      for (int axis = 0; axis < 3; ++axis) {
        sides[side][axis] = corners[(side + 1) % 3][axis] - corners[side][axis];
      }
      longest2 = max_of(longest2, dot_product(sides[side], sides[side]));
    }
    cross_product(sides[0], sides[1], normal);
    const double area = sqrt(dot_product(normal, normal));
    constexpr double thin = 1e-4;  // axes of wider ones are accurate to 1e-12
    if (!(area > thin * longest2)) return axes;
    for (int axis = 0; axis < 3; ++axis) axes.across[axis] = normal[axis] / area;
    axes.height = -dot_product(axes.across, corners[0]);
    for (int side = 0; side < 3; ++side) {
      axes.length[side] = sqrt(dot_product(sides[side], sides[side]));
      for (int axis = 0; axis < 3; ++axis) {
        axes.along[side][axis] = sides[side][axis] / axes.length[side];
      }
      cross_product(axes.along[side], axes.across, axes.outward[side]);
      axes.beyond[side] = -dot_product(axes.outward[side], corners[side]);
      axes.from_corner[side] = -dot_product(axes.along[side], corners[side]);
    }
    return axes;
  }

  TETWARP_HD static void cross_product(const double* a, const double* b, double* c) {
    for (int axis = 0; axis < 3; ++axis) {
      const int next = (axis + 1) % 3, last = (axis + 2) % 3;
      c[axis] = a[next] * b[last] - a[last] * b[next];
    }
  }

  /// Squares of distances that positions in a row do not fall below: of those to the planes through
  /// the triangle and outwards of its sides.
  /// @param first, step  from the ball's center, and from one position to the next
  template <int lanes>
  TETWARP_HD void set_least2(const double* first, const double* step, double* least2) const {
    double at[4] = {height + dot_product(across, first)}, by[4] = {dot_product(across, step)};
    for (int side = 0; side < 3; ++side) {
      at[side + 1] = beyond[side] + dot_product(outward[side], first);
      by[side + 1] = dot_product(outward[side], step);
    }
    for (int lane = 0; lane < lanes; ++lane) {
      const double outside = max_of(max_of(at[1] + lane * by[1], at[2] + lane * by[2]),
                                    max_of(at[3] + lane * by[3], 0.0));
      least2[lane] = square_of(at[0] + lane * by[0]) + square_of(outside);
    }
  }

  /// Square of the distance of a position; 0 of thin triangles.
  TETWARP_HD double distance2(const double* from_center) const {
    double outside = 0, nearest2 = INFINITY;
    for (int side = 0; side < 3; ++side) {
      const double out = beyond[side] + dot_product(outward[side], from_center);
      const double from = from_corner[side] + dot_product(along[side], from_center);
      const double past = max_of(max_of(-from, from - length[side]), 0.0);
      outside = max_of(outside, out);
      nearest2 = min_of(nearest2, square_of(out) + square_of(past));
    }
    const double above = height + dot_product(across, from_center);
    return square_of(above) + (outside > 0 ? nearest2 : 0);
  }
};

/// Finds the nearest triangles of positions within a ball, each with the bits of find_nearest().
/// For the host: it holds the triangles that may be the nearest ones, 37 kB.
class SurfaceNear {
 public:
  static constexpr int lanes = 4;  ///< positions of a row

  /// @param center  of the ball [world], as of SurfaceNode::at
  /// @param reach   distance from which on positions have no nearest point; infinite: all have one
  TETWARP_ANY_EXEC SurfaceNear(const SurfaceTree& tree,
                               const double* center,
                               double radius,
                               double reach)
      : tree_(tree) {
    for (int axis = 0; axis < 3; ++axis) center_[axis] = center[axis];
    margin_ = 1e4 * distance_rounding(tree, center) + 1e-10 * radius;  // of TriangleAxes
    const double far = reach + radius + margin_;
    NearestSurfacePoint nearest = {far * far, -1, {}};
    find_nearest(tree, center, nearest);
    limit_ = min_of(far, sqrt(nearest.distance2) + 2 * radius + margin_) + margin_;
    collect();
  }

  /// Whether all near triangles are in the list; else it is not used.
  TETWARP_ANY_EXEC bool is_complete() const { return count_ <= most; }

  /// No position of the ball is within reach of the surface.
  TETWARP_ANY_EXEC bool is_far() const { return count_ == 0; }

  /// The following positions are first + lane * step, all within the ball.
  TETWARP_ANY_EXEC void begin_row(const double* first, const double* step) {
    double from_center[3];
    for (int axis = 0; axis < 3; ++axis) from_center[axis] = first[axis] - center_[axis];
    for (int n = 0; n < kept(); ++n) {
      axes_[n].set_least2<lanes>(from_center, step, least2_[n]);
    }
  }

  /// As find_nearest().
  /// @param x  position of the lane
  TETWARP_ANY_EXEC void find(int lane, const double* x, NearestSurfacePoint& nearest) const {
    const std::int64_t known = nearest.triangle;
    double from_center[3];
    for (int axis = 0; axis < 3; ++axis) from_center[axis] = x[axis] - center_[axis];
    double distance = sqrt(nearest.distance2), far2 = square_of(distance + margin_);
    for (int n = 0; n < kept(); ++n) {
      if (least2_[n][lane] > far2 || triangles_[n] == known) continue;
      if (axes_[n].distance2(from_center) > far2) continue;
      take_triangle(tree_, triangles_[n], x, nearest);
      distance = sqrt(nearest.distance2);
      far2 = square_of(distance + margin_);
    }
    // Triangles that were not collected are farther from the center than the limit.
    const bool is_sure = distance + sqrt(dot_product(from_center, from_center)) + margin_ <= limit_;
    if (!is_complete() || !is_sure) find_nearest(tree_, x, nearest);
  }

 private:
  static constexpr int most = 128;

  TETWARP_ANY_EXEC int kept() const { return count_ > most ? 0 : count_; }

  /// Adds the triangles that may be within the limit of the center.
  TETWARP_ANY_EXEC void collect() {
    const double limit2 = square_of(limit_ + margin_);
    visit_leaves(
        tree_, center_,
        [&](std::int64_t node) { return box_distance2(tree_.boxes[node], center_) <= limit2; },
        [&](std::int64_t leaf) {
          const std::int64_t past = tree_.first_triangle(leaf + 1);
          for (std::int64_t t = tree_.first_triangle(leaf); t < past; ++t) add(t, limit2);
          return count_ <= most;
        });
  }

  TETWARP_ANY_EXEC void add(std::int64_t triangle, double limit2) {
    double corners[3][3];
    for (int c = 0; c < 3; ++c) {
      const SurfaceNode& node = tree_.nodes[tree_.triangles[3 * triangle + c]];
      for (int axis = 0; axis < 3; ++axis) corners[c][axis] = node.at[axis] - center_[axis];
    }
    const TriangleAxes axes = TriangleAxes::of(corners);
    const double center[3] = {0, 0, 0};
    if (axes.distance2(center) > limit2) return;
    if (count_ < most) {
      triangles_[count_] = triangle;
      axes_[count_] = axes;
    }
    ++count_;
  }

  const SurfaceTree& tree_;
  double center_[3];
  double margin_;
  double limit_;   ///< distance from the center
  int count_ = 0;  ///< above `most`: there are too many, and all are searched
  std::int64_t triangles_[most];
  TriangleAxes axes_[most];
  double least2_[most][lanes];
};

}  // namespace tetwarp

/// @file collide_item.hpp
/// Items of the broad phase with the features that they own, the pairs of bodies that may touch,
/// and boxes.
///
/// An item is a triangle, a capsule, or a vertex that belongs to neither (a sphere). Each vertex
/// and each edge is owned by the first item that has it, so that each pair of features belongs to
/// exactly one pair of items.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/collide/moving_points.hpp"

namespace tetwarp {

struct CollideItem {
  std::int32_t vertex[3];      ///< -1 from `count` on
  std::int32_t owned_edge[3];  ///< from vertex k to k + 1; -1: none, or owned by another item
  std::int32_t face;           ///< the triangle, -1: none
  std::int32_t body;
  std::int32_t count;        ///< of vertices: 1 sphere, 2 capsule, 3 triangle
  std::int32_t owns_vertex;  ///< bit k: owns vertex[k]
};

struct CollideBody {
  std::int32_t item_end;  ///< items of a body are contiguous, bodies ascend
  std::int32_t has_unknowns, touches_itself, is_rigid;
  std::int32_t forbidden_begin, forbidden_end;  ///< in the list of bodies that it never touches
};

/// Surfaces as the stages read them; constant during a simulation.
struct CollideView {
  View<const CollideItem> items;
  View<const CollideBody> bodies;
  View<const std::int32_t> forbidden;  ///< larger bodies that each body never touches, ascending
  View<const std::int32_t> vertex_body;
  View<const double> vertex_radius;
  View<const std::int32_t> edges;  ///< [edges][2]
  View<const double> edge_radius;
  View<const std::int32_t> triangles;  ///< [triangles][3]
  View<const std::int32_t> plane_body;

  /// Whether features of bodies a <= b can be a pair.
  TETWARP_HD bool may_touch(std::int32_t a, std::int32_t b) const {
    const CollideBody& body = bodies[a];
    if (a == b) return body.touches_itself != 0 && body.has_unknowns != 0;
    if (body.has_unknowns == 0 && bodies[b].has_unknowns == 0) return false;
    for (std::int32_t k = body.forbidden_begin; k < body.forbidden_end; ++k) {
      if (forbidden[k] == b) return false;
    }
    return true;
  }
};

/// Places of vertices, planes and frames at the start and the end of a motion; arrays as in
/// SurfaceMotion.
struct MotionView {
  View<const double> start, end;              ///< [vertices][3]
  View<const double> sagitta;                 ///< [vertices]
  View<const double> plane_start, plane_end;  ///< [planes][6]: point, normal
  View<const TurningFrame> frames;            ///< [bodies], or empty

  /// @returns null where the body does not turn, or its frame is not known
  TETWARP_HD const TurningFrame* frame_of(std::int32_t body) const {
    if (frames.size == 0 || !(dot3(frames[body].turn, frames[body].turn) > 0)) return nullptr;
    return &frames[body];
  }
};

struct Box {
  double low[3], high[3];
};

TETWARP_HD void add_box(Box& box, const Box& other) {
  for (int k = 0; k < 3; ++k) {
    box.low[k] = min_of(box.low[k], other.low[k]);
    box.high[k] = max_of(box.high[k], other.high[k]);
  }
}
TETWARP_HD bool overlap(const Box& a, const Box& b) {
  return (a.low[0] <= b.high[0]) & (b.low[0] <= a.high[0]) & (a.low[1] <= b.high[1]) &
         (b.low[1] <= a.high[1]) & (a.low[2] <= b.high[2]) & (b.low[2] <= a.high[2]);
}
TETWARP_HD bool is_within(const Box& inner, const Box& outer) {
  bool within = true;
  for (int k = 0; k < 3; ++k) {
    within &= (outer.low[k] <= inner.low[k]) & (inner.high[k] <= outer.high[k]);
  }
  return within;
}

}  // namespace tetwarp

/// @file pair_touch.hpp
/// Stage "pair_touch" of collision detection: when two features touch, and their distance at the
/// start.
#pragma once
#include <cstdint>

#include "kernels/collide/collide_item.hpp"
#include "kernels/collide/pair_ccd.hpp"
#include "kernels/collide/pair_distance.hpp"
#include "kernels/collide/pair_kind.hpp"
#include "kernels/collide/plane_ccd.hpp"

namespace tetwarp {

/// The vertices of a pair: first those of a, then those of b.
struct PairVertices {
  std::int32_t vertex[4];
  std::int32_t count_a, count;
};

TETWARP_HD PairVertices vertices_of(const CollideView& scene, const FeaturePair& pair) {
  PairVertices own{{pair.a, pair.b, 0, 0}, 1, 2};
  const std::int64_t a = pair.a, b = pair.b;
  if (pair.kind == PairKind::vertex_face) {
    for (int k = 0; k < 3; ++k) own.vertex[1 + k] = scene.triangles[3 * b + k];
    own.count = 4;
  } else if (pair.kind == PairKind::edge_edge) {
    for (int k = 0; k < 2; ++k) {
      own.vertex[k] = scene.edges[2 * a + k];
      own.vertex[2 + k] = scene.edges[2 * b + k];
    }
    own.count_a = 2;
    own.count = 4;
  } else if (pair.kind == PairKind::vertex_edge) {
    for (int k = 0; k < 2; ++k) own.vertex[1 + k] = scene.edges[2 * b + k];
    own.count = 3;
  } else if (pair.kind == PairKind::vertex_plane) {
    own.count = 1;
  }
  return own;
}

/// The body of a, and that of b.
TETWARP_HD void bodies_of(const CollideView& scene, const FeaturePair& pair, std::int32_t* bodies) {
  const PairVertices own = vertices_of(scene, pair);
  bodies[0] = scene.vertex_body[own.vertex[0]];
  bodies[1] = own.count > own.count_a ? scene.vertex_body[own.vertex[own.count_a]]
                                      : scene.plane_body[pair.b];
}

/// The radius of a, and that of b; of faces and planes 0.
TETWARP_HD void radii_of(const CollideView& scene, const FeaturePair& pair, double* radii) {
  const bool is_edge_a = pair.kind == PairKind::edge_edge;
  radii[0] = is_edge_a ? scene.edge_radius[pair.a] : scene.vertex_radius[pair.a];
  radii[1] = is_edge_a || pair.kind == PairKind::vertex_edge ? scene.edge_radius[pair.b]
             : pair.kind == PairKind::vertex_vertex          ? scene.vertex_radius[pair.b]
                                                             : 0;
}
/// Sum of the radii of both features.
TETWARP_HD double radius_of(const CollideView& scene, const FeaturePair& pair) {
  double radii[2];
  radii_of(scene, pair, radii);
  return radii[0] + radii[1];
}

/// The nearest points of the features of a pair, without their radii.
/// @param kind    not vertex_plane
/// @param x       places of vertices_of()
/// @param weight  out: of these vertices in the point of their side, [4]
/// @returns their distance
TETWARP_HD double axis_distance(PairKind kind, const double* const* x, double* weight) {
  weight[0] = weight[1] = 1;
  if (kind == PairKind::vertex_face) {
    return vertex_face_distance(x[0], x[1], x[2], x[3], weight + 1);
  }
  double s = 0, t = 0, distance = 0;
  if (kind == PairKind::edge_edge) {
    distance = edge_edge_distance(x[0], x[1], x[2], x[3], &s, &t);
    weight[0] = 1 - s, weight[1] = s, weight[2] = 1 - t, weight[3] = t;
  } else if (kind == PairKind::vertex_edge) {
    distance = edge_edge_distance(x[0], x[0], x[1], x[2], &s, &t);
    weight[1] = 1 - t, weight[2] = t;
  } else {
    distance = edge_edge_distance(x[0], x[0], x[1], x[1], &s, &t);
  }
  return distance;
}

/// One index = one pair of features. Writes its own entry; any order.
struct PairTouchOp {
  static constexpr int resident_blocks = 1;  ///< else registers are spilled

  CollideView scene;
  MotionView motion;
  CcdLimits limits;
  View<const FeaturePair> pairs;
  View<CcdResult> results;  ///< out

  TETWARP_HD void operator()(std::int64_t i) const {
    const FeaturePair pair = pairs[i];
    const PairVertices own = vertices_of(scene, pair);
    MovingPoints points{};
    points.radius = radius_of(scene, pair);
    for (int k = 0; k < own.count; ++k) {
      const std::int64_t v = own.vertex[k];
      points.start[k] = motion.start.data + 3 * v;
      points.end[k] = motion.end.data + 3 * v;
      double& sagitta = k < own.count_a ? points.sagitta_a : points.sagitta_b;
      sagitta = max_of(sagitta, motion.sagitta[v]);
    }
    points.frame_a = motion.frame_of(scene.vertex_body[own.vertex[0]]);
    if (own.count > own.count_a) {
      points.frame_b = motion.frame_of(scene.vertex_body[own.vertex[own.count_a]]);
    }
    results[i] = result_of(pair, points);
  }

 private:
  TETWARP_HD CcdResult result_of(const FeaturePair& pair, const MovingPoints& points) const {
    switch (pair.kind) {
      case PairKind::vertex_face:
        return vertex_face_ccd(points, limits);
      case PairKind::edge_edge:
        return edge_edge_ccd(points, limits);
      case PairKind::vertex_edge:
        return vertex_edge_ccd(points, limits);
      case PairKind::vertex_vertex:
        return vertex_vertex_ccd(points, limits);
      default:
        break;
    }
    const double* const start = motion.plane_start.data + 6 * std::int64_t{pair.b};
    const double* const end = motion.plane_end.data + 6 * std::int64_t{pair.b};
    const TurningFrame* const frame = motion.frame_of(scene.plane_body[pair.b]);
    return vertex_plane_ccd(points, MovingPlane{start, start + 3, end, end + 3, frame}, limits);
  }
};

/// A pair that touches, or is near at the start.
struct FeatureTouch {
  FeaturePair pair;
  double time, start_distance;
};

/// One index = one pair of features. Appends those that touch or start within a distance, except
/// pairs of two still bodies.
struct TouchFilterOp {
  CollideView scene;
  View<const std::uint8_t> is_still;  ///< [bodies], or empty: none
  View<const FeaturePair> pairs;
  View<const CcdResult> results;
  double near_at_start;  ///< distance at the start up to which a pair is near [m]

  template <class Emit>
  TETWARP_HD void operator()(std::int64_t i, Emit& emit) const {
    const CcdResult& result = results[i];
    emit.tally(result.evaluations);
    if (!(result.time <= 1 || result.start_distance < near_at_start)) return;
    std::int32_t bodies[2];
    if (is_still.size > 0) {
      bodies_of(scene, pairs[i], bodies);
      if (is_still[bodies[0]] != 0 && is_still[bodies[1]] != 0) return;
    }
    emit(FeatureTouch{pairs[i], result.time, result.start_distance});
  }
};

/// One index = one pair. Appends those of its bodies that have unknowns and are still.
struct ReachedOp {
  CollideView scene;
  View<const std::uint8_t> is_still;  ///< [bodies]
  View<const FeatureTouch> pairs;

  template <class Emit>
  TETWARP_HD void operator()(std::int64_t i, Emit& emit) const {
    std::int32_t bodies[2];
    bodies_of(scene, pairs[i].pair, bodies);
    for (int k = 0; k < 2; ++k) {
      if (is_still[bodies[k]] != 0 && scene.bodies[bodies[k]].has_unknowns != 0) emit(bodies[k]);
    }
  }
};

}  // namespace tetwarp

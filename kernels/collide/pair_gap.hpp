/// @file pair_gap.hpp
/// Stage "pair_gap" of collision detection: the nearest pair of features.
#pragma once
#include <cstdint>

#include "kernels/collide/pair_touch.hpp"

namespace tetwarp {

struct PairGap {
  FeaturePair pair;
  double distance;
};

/// Whether a comes before b: by distance, then by the numbers of the features.
TETWARP_HD bool is_nearer(const PairGap& a, const PairGap& b) {
  if (a.distance != b.distance) return a.distance < b.distance;
  if (a.pair.kind != b.pair.kind) return a.pair.kind < b.pair.kind;
  return a.pair.a != b.pair.a ? a.pair.a < b.pair.a : a.pair.b < b.pair.b;
}

constexpr std::int64_t gap_run = 64;  ///< pairs of one index of PairGapOp

/// One index = gap_run pairs of features. Writes the nearest of them.
struct PairGapOp {
  CollideView scene;
  MotionView motion;  ///< only its start is read
  View<const FeaturePair> pairs;
  View<PairGap> gaps;  ///< out

  TETWARP_HD void operator()(std::int64_t run) const {
    const std::int64_t end = min_of(pairs.size, (run + 1) * gap_run);
    PairGap nearest = gap_of(pairs[run * gap_run]);
    for (std::int64_t i = run * gap_run + 1; i < end; ++i) {
      const PairGap gap = gap_of(pairs[i]);
      if (is_nearer(gap, nearest)) nearest = gap;
    }
    gaps[run] = nearest;
  }

  TETWARP_HD PairGap gap_of(const FeaturePair& pair) const {
    return {pair, height_or_distance(pair) - radius_of(scene, pair)};
  }

 private:
  /// Distance of the features without their radii.
  TETWARP_HD double height_or_distance(const FeaturePair& pair) const {
    const PairVertices own = vertices_of(scene, pair);
    const double* x[4] = {};
    for (int k = 0; k < own.count; ++k) {
      x[k] = motion.start.data + 3 * std::int64_t{own.vertex[k]};
    }
    double weight[4];
    if (pair.kind != PairKind::vertex_plane) return axis_distance(pair.kind, x, weight);
    const double* const plane = motion.plane_start.data + 6 * std::int64_t{pair.b};
    double height = 0;
    for (int k = 0; k < 3; ++k) height += plane[3 + k] * (x[0][k] - plane[k]);
    return height;
  }
};

}  // namespace tetwarp

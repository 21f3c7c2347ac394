/// @file pair_features.hpp
/// Stage "pair_features" of collision detection: the pairs of features of pairs of items, and
/// vertices near planes.
#pragma once
#include <cstdint>

#include "kernels/collide/entry_pairs.hpp"
#include "kernels/collide/pair_apart.hpp"
#include "kernels/collide/pair_kind.hpp"

namespace tetwarp {

/// The planes that vertices of each body may touch.
struct PlaneView {
  View<const std::int32_t> start;   ///< [bodies + 1], into `planes`; empty: none is near
  View<const std::int32_t> planes;  ///< those near each body
};

/// One index = one pair of items; the indices after those = one vertex each with the planes near
/// its body. Appends the pairs of features that are not certain to stay apart, each pair of a scene
/// once.
struct PairFeaturesOp {
  CollideView scene;
  View<const ItemPair> pairs;
  MotionView motion;
  double distance;  ///< search distance [m]
  PlaneView near;

  template <class Emit>
  TETWARP_HD void operator()(std::int64_t i, Emit& emit) const {
    if (i < pairs.size) {
      items(pairs[i], emit);
    } else {
      planes(static_cast<std::int32_t>(i - pairs.size), emit);
    }
  }

 private:
  template <class Emit>
  TETWARP_HD void items(const ItemPair& pair, Emit& emit) const {
    const CollideItem& a = scene.items[pair.a];
    const CollideItem& b = scene.items[pair.b];
    const double* const origin = motion.start.data + 3 * std::int64_t{a.vertex[0]};
    ItemPoints points_a(a, motion, scene.vertex_radius, origin);
    ItemPoints points_b(b, motion, scene.vertex_radius, origin);
    const double apart = distance_apart(points_a, points_b, distance);
    if (neighbors_apart(a, points_a, b, points_b, apart)) return;
    points_a.find_bounds();
    points_b.find_bounds();
    if (bounds_apart(points_a.bounds, points_b.bounds, apart)) return;
    if (b.face >= 0) {
      const FaceSides sides(points_b, points_a, apart);
      if (sides.all()) return;
      if (a.face >= 0) {
        const FaceSides other_sides(points_a, points_b, apart);
        if (other_sides.all()) return;
        vertices_to_face(b, points_b, other_sides, a, points_a, apart, emit);
      }
      vertices_to_face(a, points_a, sides, b, points_b, apart, emit);
    } else if (a.face >= 0) {
      const FaceSides sides(points_a, points_b, apart);
      if (sides.all()) return;
      vertices_to_face(b, points_b, sides, a, points_a, apart, emit);
    }
    if (a.count == 1 && b.count == 1) return spheres(a.vertex[0], b.vertex[0], emit);
    if (a.count == 1 && b.count == 2) return sphere_to_axis(a.vertex[0], b, emit);
    if (a.count == 2 && b.count == 1) return sphere_to_axis(b.vertex[0], a, emit);
    if (a.count > 1 && b.count > 1) edges(a, points_a, b, points_b, apart, emit);
  }

  /// Whether all features that share no vertex stay apart, along one direction for items that share
  /// none or one.
  TETWARP_HD bool neighbors_apart(const CollideItem& a,
                                  const ItemPoints& points_a,
                                  const CollideItem& b,
                                  const ItemPoints& points_b,
                                  double apart) const {
    if (a.body != b.body) return middles_apart(points_a, points_b, apart);
    int shared = 0, of_a = 0, of_b = 0;
    for (int k = 0; k < a.count; ++k) {
      for (int l = 0; l < b.count; ++l) {
        if (a.vertex[k] != b.vertex[l]) continue;
        ++shared;
        of_a = k;
        of_b = l;
      }
    }
    if (shared == 0) return middles_apart(points_a, points_b, apart);
    return shared == 1 && a.count == 3 && b.count == 3 &&
           fans_apart(points_a, of_a, points_b, of_b, apart);
  }

  template <class Emit>
  TETWARP_HD void vertices_to_face(const CollideItem& from,
                                   const ItemPoints& points,
                                   const FaceSides& sides,
                                   const CollideItem& to,
                                   const ItemPoints& face,
                                   double apart,
                                   Emit& emit) const {
    for (int k = 0; k < from.count; ++k) {
      const std::int32_t v = from.vertex[k];
      if ((from.owns_vertex >> k & 1) == 0 || sides.side[k] != 0) continue;
      if (v == to.vertex[0] || v == to.vertex[1] || v == to.vertex[2]) continue;
      if (bounds_apart(points.corner_bounds(k), face.bounds, apart)) continue;
      emit(FeaturePair{PairKind::vertex_face, v, to.face});
    }
  }

  template <class Emit>
  TETWARP_HD void edges(const CollideItem& a,
                        const ItemPoints& points_a,
                        const CollideItem& b,
                        const ItemPoints& points_b,
                        double apart,
                        Emit& emit) const {
    const int count_a = a.count == 2 ? 1 : 3, count_b = b.count == 2 ? 1 : 3;
    for (int k = 0; k < count_a; ++k) {
      if (a.owned_edge[k] < 0) continue;
      const MovingBounds bounds = points_a.edge_bounds(k);
      if (bounds_apart(bounds, points_b.bounds, apart)) continue;
      for (int l = 0; l < count_b; ++l) {
        if (b.owned_edge[l] < 0 || share_vertex(a, k, b, l)) continue;
        if (bounds_apart(bounds, points_b.edge_bounds(l), apart)) continue;
        if (edges_apart(points_a, k, points_b, l, apart)) continue;
        const std::int32_t e = a.owned_edge[k], f = b.owned_edge[l];
        emit(FeaturePair{PairKind::edge_edge, min_of(e, f), max_of(e, f)});
      }
    }
  }
  TETWARP_HD bool share_vertex(const CollideItem& a, int k, const CollideItem& b, int l) const {
    const std::int32_t p = a.vertex[k], q = a.vertex[(k + 1) % a.count];
    const std::int32_t r = b.vertex[l], s = b.vertex[(l + 1) % b.count];
    return p == r || p == s || q == r || q == s;
  }

  template <class Emit>
  TETWARP_HD void spheres(std::int32_t v, std::int32_t w, Emit& emit) const {
    if (!(scene.vertex_radius[v] > 0) || !(scene.vertex_radius[w] > 0)) return;
    emit(FeaturePair{PairKind::vertex_vertex, min_of(v, w), max_of(v, w)});
  }
  template <class Emit>
  TETWARP_HD void sphere_to_axis(std::int32_t v, const CollideItem& capsule, Emit& emit) const {
    if (!(scene.vertex_radius[v] > 0) || capsule.owned_edge[0] < 0) return;
    emit(FeaturePair{PairKind::vertex_edge, v, capsule.owned_edge[0]});
  }

  template <class Emit>
  TETWARP_HD void planes(std::int32_t v, Emit& emit) const {
    const std::int32_t body = scene.vertex_body[v];
    for (std::int32_t k = near.start[body]; k < near.start[body + 1]; ++k) {
      const std::int32_t plane = near.planes[k];
      const double least = least_height(v, plane) - turned_height(v, plane);
      if (least <= distance + scene.vertex_radius[v] + motion.sagitta[v]) {
        emit(FeaturePair{PairKind::vertex_plane, v, plane});
      }
    }
  }
  /// A lower bound of the height of a vertex above a plane during the motion. The plane's normal is
  /// a combination of those at start and end whose weights add up to at least 1, so the bound is
  /// the smallest of the four heights, if that is positive.
  TETWARP_HD double least_height(std::int32_t v, std::int32_t plane) const {
    const double* const x[2] = {motion.start.data + 3 * std::int64_t{v},
                                motion.end.data + 3 * std::int64_t{v}};
    const double* const own[2] = {motion.plane_start.data + 6 * std::int64_t{plane},
                                  motion.plane_end.data + 6 * std::int64_t{plane}};
    double least = 0;
    for (int n = 0; n < 2; ++n) {
      for (int t = 0; t < 2; ++t) {
        double height = 0, size = 0;
        for (int k = 0; k < 3; ++k) {
          const double apart = x[t][k] - own[t][k];
          height += own[n][3 + k] * apart;
          size = max_of(size, max_of(fabs(x[t][k]), fabs(own[t][k])));
        }
        height -= 0x1p-46 * size;  // roundings
        if ((n == 0 && t == 0) || height < least) least = height;
      }
    }
    return least;
  }
  /// Upper bound of the height of a plane that follows a frame above one whose point moves straight
  /// and whose normal is interpolated linearly: point and normal differ by at most an eighth of
  /// their second derivatives.
  TETWARP_HD double turned_height(std::int32_t v, std::int32_t plane) const {
    const TurningFrame* const frame = motion.frame_of(scene.plane_body[plane]);
    if (frame == nullptr) return 0;
    const double square = dot3(frame->turn, frame->turn);
    double reach = 0, arm[3], way[3];
    for (int t = 0; t < 2; ++t) {
      const View<const double>& x = t == 0 ? motion.start : motion.end;
      const View<const double>& own = t == 0 ? motion.plane_start : motion.plane_end;
      minus3(x.data + 3 * std::int64_t{v}, own.data + 6 * std::int64_t{plane}, way);
      reach = max_of(reach, sqrt(dot3(way, way)));
    }
    minus3(motion.plane_start.data + 6 * std::int64_t{plane}, frame->center, arm);
    const double bow = sqrt(dot3(arm, arm)) * square / 8;
    return bow + (reach + bow) * square / 8;
  }
};

}  // namespace tetwarp

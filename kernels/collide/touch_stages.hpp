/// @file touch_stages.hpp
/// Stages from the pairs that a step found to the touches that become contacts.
#pragma once
#include <cstdint>

#include "kernels/base/heap_sort.hpp"
#include "kernels/base/key_value.hpp"
#include "kernels/collide/touch_on_way.hpp"

namespace tetwarp {

/// One index = one pair. Writes its touch at the nearest points; any order.
struct TouchOp {
  static constexpr int resident_blocks = 1;  ///< else registers are spilled

  View<const FeatureTouch> pairs;
  TouchView view;
  std::int32_t pass;
  View<PairTouch> touches;  ///< out

  TETWARP_HD void operator()(std::int64_t i) const {
    const FeatureTouch& pair = pairs[i];
    TouchMaker maker(pair, pass, view);
    TouchMaker ends = maker, other = maker;
    PairTouch touch = maker.make();
    touch.counts = maker.is_nearest();
    touch.is_hit = touch.counts && pair.time <= 1;
    if (!touch.is_hit && pair.start_distance < 2 * view.thickness) {
      touch = touch_on_way(pair, pass, view).touch;
    }
    double part[2];
    if (touch.is_of_edges()) {
      touch.counts = touch.counts && touch.is_inside;
      touch.has_ends = ends.overlaps(part);
    }
    if (touch.has_ends) {
      // A third contact between two ends with the same gap would change nothing.
      const double gap = min_of(ends.make_at(part[0], 1).gap, other.make_at(part[1], 2).gap);
      touch.counts = touch.counts && gap > touch.gap + same_gap * view.thickness;
    }
    touches[i] = touch;
  }

 private:
  static constexpr double same_gap = 0.1;  ///< thicknesses
};

/// One index = one pair and its touch. Appends the touches at both ends of an overlap of capsules.
struct EndTouchOp {
  View<const FeatureTouch> pairs;
  View<const PairTouch> touches;
  TouchView view;
  std::int32_t pass;

  template <class Emit>
  TETWARP_HD void operator()(std::int64_t i, Emit& emit) const {
    if (!touches[i].has_ends) return;
    TouchMaker begin(pairs[i], pass, view);
    TouchMaker end = begin;
    double part[2];
    begin.overlaps(part);
    emit(begin.make_at(part[0], 1));
    emit(end.make_at(part[1], 2));
  }
};

/// One index = one pair and its touch. Appends the pair if the touch is a hit.
struct HitOp {
  View<const FeatureTouch> pairs;
  View<const PairTouch> touches;

  template <class Emit>
  TETWARP_HD void operator()(std::int64_t i, Emit& emit) const {
    if (touches[i].is_hit) emit(pairs[i]);
  }
};

/// One index = one pair that is hit. Appends it if its features are what is nearest of their
/// surfaces at the hit.
struct NearestHitOp {
  static constexpr int resident_blocks = 1;  ///< else registers are spilled

  View<const FeatureTouch> pairs;
  TouchView view;

  template <class Emit>
  TETWARP_HD void operator()(std::int64_t i, Emit& emit) const {
    TouchMaker maker(pairs[i], 0, view);
    maker.make();
    if (maker.is_nearest()) emit(pairs[i]);
  }
};

/// The touches of a step: those of the first detection, those at the ends of overlaps, and those of
/// later detections.
struct TouchList {
  View<const PairTouch> first, ends, later;

  TETWARP_HD std::int64_t size() const { return first.size + ends.size + later.size; }
  TETWARP_HD const PairTouch& operator[](std::int64_t i) const {
    if (i < first.size) return first[i];
    const std::int64_t k = i - first.size;
    return k < ends.size ? ends[k] : later[k - ends.size];
  }
};

/// One index = one touch. Writes its own copy; any order.
struct TouchCopyOp {
  TouchList from;
  View<PairTouch> to;  ///< out

  TETWARP_HD void operator()(std::int64_t i) const { to[i] = from[i]; }
};

/// One index = one touch. Writes its key: the first feature, with edges after vertices, and the
/// number of the touch.
struct TouchKeyOp {
  TouchList touches;
  std::int64_t vertex_count;

  TETWARP_HD KeyValue operator()(std::int64_t i) const {
    const PairTouch& touch = touches[i];
    const std::int64_t first = touch.is_of_edges() ? vertex_count : 0;
    return make_key_value(first + touch.a, i);
  }
};

/// One index = one touch in the order of first features. The index of the first touch of a feature
/// orders and marks all touches of that feature. Touches of edges are all kept. Of a vertex, the
/// nearest touch with each other body is kept: touches that are near at the start by distance, then
/// those hit on the way by time. Its touches with other parts of that body are also kept where
/// these face elsewhere, see TouchChoice. Where a pair is near in one detection and hit in a later
/// one, the later touch replaces the earlier one.
struct TouchChoiceOp {
  static constexpr int resident_blocks = 1;  ///< else registers are spilled
  enum Mark : std::int8_t { dropped, kept, kept_with_area };

  TouchList touches;
  CollideView scene;
  View<const KeyValue> given;  ///< sorted by first feature
  View<KeyValue> order;        ///< out: the same; touches of a vertex by body, time and distance
  View<std::int8_t> mark;      ///< out [order] Mark

  TETWARP_HD void operator()(std::int64_t i) const {
    if (i > 0 && key_of(given[i - 1]) == key_of(given[i])) return;
    std::int64_t end = i;
    for (; end < given.size && key_of(given[end]) == key_of(given[i]); ++end) {
      order[end] = given[end];
    }
    if (touch_at(i).is_of_edges()) {
      for (std::int64_t k = i; k < end; ++k) mark[k] = is_left_out(k, i, end) ? dropped : kept;
      return;
    }
    heap_sort(order.data + i, end - i, [this](KeyValue p, KeyValue q) {
      return comes_before(touches[value_of(p)], touches[value_of(q)]);
    });
    for (std::int64_t first = i; first < end;) first = choose(first, i, end);
  }

 private:
  TETWARP_HD const PairTouch& touch_at(std::int64_t k) const { return touches[value_of(order[k])]; }

  TETWARP_HD static bool comes_before(const PairTouch& p, const PairTouch& q) {
    if (p.body_b != q.body_b) return p.body_b < q.body_b;
    if (p.time != q.time) return p.time < q.time;
    if (p.distance != q.distance) return p.distance < q.distance;
    if (p.kind != q.kind) return p.kind < q.kind;
    if (p.b != q.b) return p.b < q.b;
    return p.end != q.end ? p.end < q.end : p.pass < q.pass;
  }
  /// Whether a touch does not count, or its pair has a later one.
  /// @param begin, end  of the same first feature
  TETWARP_HD bool is_left_out(std::int64_t k, std::int64_t begin, std::int64_t end) const {
    const PairTouch& own = touch_at(k);
    if (!own.counts) return true;
    if (touches.later.size == 0) return false;
    for (std::int64_t j = begin; j < end; ++j) {
      const PairTouch& other = touch_at(j);
      if (other.pass > own.pass && other.kind == own.kind && other.b == own.b) return true;
    }
    return false;
  }
  /// Whether the nearest point is on an edge or a corner of the other body that a nearer touch
  /// shares.
  TETWARP_HD static bool is_edge_of(const PairTouch& touch, const PairTouch& nearer) {
    bool is_inside = true;
    for (int k = 0; k < 3; ++k) {
      const std::int32_t vertex = touch.vertex_b[k];
      if (vertex < 0) continue;
      if (!(touch.weight_b[k] > 0)) {
        is_inside = false;
        continue;
      }
      if (vertex != nearer.vertex_b[0] && vertex != nearer.vertex_b[1] &&
          vertex != nearer.vertex_b[2]) {
        return false;
      }
    }
    return !is_inside && touch.vertex_b[0] >= 0;
  }

  /// Marks the touches with one body from `first` on.
  /// @returns the index after the last of them
  TETWARP_HD std::int64_t choose(std::int64_t first, std::int64_t begin, std::int64_t end) const {
    const std::int32_t body = touch_at(first).body_b;
    const CollideBody& other = scene.bodies[body];
    const bool sinks_in = scene.vertex_radius[touch_at(first).a] > 0 && other.has_unknowns != 0 &&
                          other.is_rigid == 0;
    std::int64_t i = first;
    for (; i < end && touch_at(i).body_b == body; ++i) {
      const PairTouch& touch = touch_at(i);
      Mark own = is_left_out(i, begin, end) ? dropped : kept_with_area;
      for (std::int64_t k = first; k < i && own != dropped; ++k) {
        if (mark[k] == dropped) continue;
        const PairTouch& nearer = touch_at(k);
        const double cosine = dot(touch.normal, nearer.normal);
        if (is_edge_of(touch, nearer) || (!sinks_in && !(cosine < cosine_5))) {
          own = dropped;
        } else if (cosine >= cosine_45) {
          own = kept;  // the area is that of a nearer part that faces almost the same way
        }
      }
      mark[i] = own;
    }
    return i;
  }
};

/// One index = one touch in the order of TouchChoiceOp. Appends those that are kept, with areas.
struct ChosenTouchOp {
  TouchList touches;
  TouchAreaView areas;
  View<const double> start;  ///< [vertices][3]
  View<const KeyValue> order;
  View<const std::int8_t> mark;

  template <class Emit>
  TETWARP_HD void operator()(std::int64_t i, Emit& emit) const {
    if (mark[i] == TouchChoiceOp::dropped) return;
    const PairTouch& touch = touches[value_of(order[i])];
    emit(ChosenTouch{touch, mark[i] == TouchChoiceOp::kept_with_area ? area_of(touch) : 0});
  }

 private:
  TETWARP_HD double area_of(const PairTouch& touch) const {
    const bool is_face = touch.kind == PairKind::vertex_face;
    if (!is_face && touch.kind != PairKind::vertex_plane) return 0;
    const double seen = seen_area(areas, touch.a, touch.normal, start);
    return is_face ? area_share(areas, touch.body_a, touch.body_b) * seen : seen;
  }
};

}  // namespace tetwarp

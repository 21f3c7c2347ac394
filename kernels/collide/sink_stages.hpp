/// @file sink_stages.hpp
/// Stages that leave out the hits of a step's first detection which other contacts forbid.
///
/// The first motion of a step is without contact, so that a body sinks into what carries it, and
/// there hits features of a surface from beneath that it would slide over. Each rigid body and each
/// vertex of another body has one "way out": that of the touch that will push it out first. A hit
/// that does not happen once both sides are moved by their ways out is left out; if it does happen
/// with the contacts of the step, a later detection finds it.
#pragma once
#include <cstdint>

#include "kernels/base/key_value.hpp"
#include "kernels/collide/touch_on_way.hpp"

namespace tetwarp {

/// What owns ways out: vertices, then bodies.
struct SinkOwners {
  std::int64_t vertex_count;

  TETWARP_HD std::int64_t of_body(std::int32_t body) const { return vertex_count + body; }
};

/// How deep a touch is at the end of the first motion [m].
TETWARP_HD double depth_of(const PairTouch& touch) {
  return -(touch.gap + dot(touch.normal, touch.way));
}

/// Whether a touch pushes before another one of the same owner: a strict order of all touches.
/// Faces and planes come first: what reaches them has not passed a feature yet.
TETWARP_HD bool pushes_before(const PairTouch& p, const PairTouch& q) {
  if (p.is_of_face() != q.is_of_face()) return p.is_of_face();
  if (p.time != q.time) return p.time < q.time;
  const double depth_p = depth_of(p), depth_q = depth_of(q);
  if (depth_p != depth_q) return depth_p > depth_q;
  if (p.kind != q.kind) return p.kind < q.kind;
  return p.a != q.a ? p.a < q.a : p.b < q.b;
}

/// One index = one touch. Appends owner, number and side of each touch that sinks in, for each side
/// with unknowns: owners are the body if it is rigid, else the vertices of the nearest point. The
/// bit of accepted pairs is set for side b.
struct SinkOp {
  View<const PairTouch> touches;
  TouchView view;
  SinkOwners owners;

  template <class Emit>
  TETWARP_HD void operator()(std::int64_t i, Emit& emit) const {
    const PairTouch& touch = touches[i];
    if (!touch.counts || (touch.time > 0 && !touch.is_hit)) return;
    if (!(depth_of(touch) > least_depth * view.thickness)) return;
    add_side(touch.body_a, touch.vertex_a, touch.weight_a, i, false, emit);
    add_side(touch.body_b, touch.vertex_b, touch.weight_b, i, true, emit);
  }

 private:
  static constexpr double least_depth = 0.05;  ///< thicknesses: the slack of the end check

  template <class Emit>
  TETWARP_HD void add_side(std::int32_t body,
                           const std::int32_t* vertex,
                           const double* weight,
                           std::int64_t i,
                           bool is_b,
                           Emit& emit) const {
    if (!view.moves(body)) return;
    if (view.is_rigid(body)) {
      emit(make_key_value(owners.of_body(body), i, is_b));
      return;
    }
    for (int k = 0; k < 3 && vertex[k] >= 0; ++k) {
      if (weight[k] > 0) emit(make_key_value(vertex[k], i, is_b));
    }
  }
};

/// Of entries that are sorted by owner: the touch that pushes first among those from `begin` on of
/// its owner and before `end`.
TETWARP_HD KeyValue first_push(View<const PairTouch> touches,
                               View<const KeyValue> sinks,
                               std::int64_t begin,
                               std::int64_t end) {
  KeyValue first = sinks[begin];
  for (std::int64_t k = begin + 1; k < end && key_of(sinks[k]) == key_of(first); ++k) {
    if (pushes_before(touches[value_of(sinks[k])], touches[value_of(first)])) first = sinks[k];
  }
  return first;
}
TETWARP_HD bool begins_owner(View<const KeyValue> sinks, std::int64_t i) {
  return i == 0 || key_of(sinks[i - 1]) != key_of(sinks[i]);
}

/// One index = one entry of SinkOp, sorted by owner. The first of an owner, and every 64th entry,
/// appends the touch that pushes first of the owner's next entries, so that no index looks at many.
struct FirstPushOp {
  View<const PairTouch> touches;
  View<const KeyValue> sinks;

  template <class Emit>
  TETWARP_HD void operator()(std::int64_t i, Emit& emit) const {
    constexpr std::int64_t length = 64;
    if (i % length != 0 && !begins_owner(sinks, i)) return;
    emit(first_push(touches, sinks, i, min_of(sinks.size, (i / length + 1) * length)));
  }
};

/// One index = one entry of FirstPushOp. The first of an owner writes the owner's way out.
struct WayOutOp {
  View<const PairTouch> touches;
  View<const KeyValue> sinks;
  View<KeyValue> ways;  ///< out [owners] an entry of the owner

  TETWARP_HD void operator()(std::int64_t i) const {
    if (!begins_owner(sinks, i)) return;
    ways[key_of(sinks[i])] = first_push(touches, sinks, i, sinks.size);
  }
};

/// One index = one owner. Writes that it has no way out; any order.
struct NoWayOutOp {
  View<KeyValue> ways;  ///< out

  TETWARP_HD void operator()(std::int64_t i) const { ways[i] = no_key_value; }
};

/// One index = one touch. Leaves it out if its features are apart by more than nine tenths of the
/// thickness at its time, once each side is moved by its way out; any order. Features that are near
/// at the start and face each other as they do then press where they are, unless both bodies
/// deform, which saves sweeps. A side is not moved where the touch itself pushes along the way out.
/// Planes have nothing that could be hit from beneath.
struct SunkHitOp {
  static constexpr int resident_blocks = 1;  ///< else registers are spilled

  View<const FeatureTouch> pairs;
  TouchView view;
  SinkOwners owners;
  View<const KeyValue> ways;
  View<PairTouch> touches;  ///< in and out: `counts` and `is_hit`

  TETWARP_HD void operator()(std::int64_t i) const {
    PairTouch& touch = touches[i];
    if (!touch.counts || touch.kind == PairKind::vertex_plane) return;
    if (!touch.is_hit && touch.is_of_face()) return;
    const KeyValue way_a = way_out(touch.body_a, touch.vertex_a, touch.weight_a);
    const KeyValue way_b = way_out(touch.body_b, touch.vertex_b, touch.weight_b);
    if (way_a == no_key_value && way_b == no_key_value) return;
    FeatureTouch at = pairs[i];
    const bool is_soft = is_deformable(touch.body_a) && is_deformable(touch.body_b);
    if (at.start_distance < 2 * view.thickness) {
      const PairTouch start = touch_at(at, 0, 0, view).touch;
      if (!is_soft && start.counts && dot(start.normal, touch.normal) >= cosine_5) return;
      if (!touch.is_hit) at.time = touch_on_way(at, 0, view).time;
      if (!(at.time > 0)) return;
    }
    const double cosine = is_soft ? cosine_20 : cosine_5;
    const Vec3 move_a = move(way_a, touch.normal, cosine, at.time);
    const Vec3 move_b = move(way_b, times(-1, touch.normal), cosine, at.time);
    if (!(norm(move_a) > 0) && !(norm(move_b) > 0)) return;
    TouchMaker maker(at, 0, view);
    maker.make();
    if (maker.distance_moved(move_a, move_b) > least_apart * view.thickness) {
      touch.is_hit = touch.counts = false;
    }
  }

 private:
  static constexpr double least_apart = 0.9;  ///< thicknesses
  /// Of the largest angle of a touch to a way out along which it pushes, between deformable bodies:
  /// 20 degrees instead of 5, since their vertices sink in one after the other.
  static constexpr double cosine_20 = 0.9396926207859084;

  TETWARP_HD bool is_deformable(std::int32_t body) const {
    return view.moves(body) && !view.is_rigid(body);
  }

  /// Of a deformable side: of its vertices' ways out, the one that pushes first.
  /// @returns no_key_value: none
  TETWARP_HD KeyValue way_out(std::int32_t body,
                              const std::int32_t* vertex,
                              const double* weight) const {
    if (view.is_rigid(body)) return ways[owners.of_body(body)];
    KeyValue first = no_key_value;
    for (int k = 0; k < 3 && vertex[k] >= 0; ++k) {
      const KeyValue own = ways[vertex[k]];
      if (!(weight[k] > 0) || own == no_key_value) continue;
      if (first == no_key_value ||
          pushes_before(touches[value_of(own)], touches[value_of(first)])) {
        first = own;
      }
    }
    return first;
  }
  /// By how much a side has been pushed out at a time.
  /// @param own     direction in which the touch pushes this side
  /// @param cosine  of its largest angle to a way out along which it pushes
  TETWARP_HD Vec3 move(KeyValue way, const Vec3& own, double cosine, double time) const {
    if (way == no_key_value) return {};
    const PairTouch& touch = touches[value_of(way)];
    const Vec3 out = flag_of(way) ? times(-1, touch.normal) : touch.normal;
    if (!(dot(out, own) < cosine)) return {};
    const double depth = time * (depth_of(touch) + touch.gap) - touch.gap;
    return times(max_of(0.0, depth), out);
  }
};

}  // namespace tetwarp

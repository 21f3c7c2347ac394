/// @file touch_maker.hpp
/// TouchMaker: the touches of a pair of features.
#pragma once
#include <cmath>
#include <cstdint>

#include "kernels/collide/nearest_cones.hpp"
#include "kernels/collide/pair_distance.hpp"
#include "kernels/collide/pair_touch.hpp"
#include "kernels/collide/touch.hpp"

namespace tetwarp {

/// Finds normal, nearest points and gap of a pair at the time of its hit. The points are material
/// points at the start of the step, moved along the normal so that they are `gap` apart.
class TouchMaker {
 public:
  /// @param view  kept by the caller
  TETWARP_ANY_EXEC TouchMaker(const FeatureTouch& pair, std::int32_t pass, const TouchView& view)
      : view_(view), time_(pair.time <= 1 ? pair.time : 0) {
    touch_.kind = pair.pair.kind;
    touch_.a = pair.pair.a;
    touch_.b = pair.pair.b;
    touch_.pass = pass;
    touch_.distance = pair.start_distance;
    touch_.time = pair.start_distance < 2 * view.thickness ? 0 : time_;
    if (time_ > 0) origin_ = view.start(touch_.is_of_edges() ? view.edge(touch_.a)[0] : touch_.a);
  }

  TETWARP_ANY_EXEC PairTouch make() {
    switch (touch_.kind) {
      case PairKind::vertex_face:
        vertex_face();
        break;
      case PairKind::edge_edge:
        edge_edge();
        break;
      case PairKind::vertex_edge:
        vertex_edge();
        break;
      case PairKind::vertex_vertex:
        vertex_vertex();
        break;
      case PairKind::vertex_plane:
        vertex_plane();
        return touch_;
    }
    finish();
    return touch_;
  }

  /// After make(): whether the nearest points of both sides are what is nearest of the surfaces
  /// around them at the time of the touch.
  TETWARP_ANY_EXEC bool is_nearest() const {
    if (touch_.kind == PairKind::vertex_plane) return true;
    return is_nearest_of(a_, touch_.body_a, times(-1, direction_)) &&
           is_nearest_of(b_, touch_.body_b, direction_);
  }

  /// After make(): how fast its nearest points come apart on the motion, times their distance
  /// [m^2 per motion]; 0 where they hardly move. Negative before the time at which the features are
  /// nearest, since the distance of convex features is a convex function of time.
  TETWARP_ANY_EXEC double opening() const {
    const View<const double> start = view_.motion.start, end = view_.motion.end;
    const Vec3 way =
        minus(minus(a_.mean(end), a_.mean(start)), minus(b_.mean(end), b_.mean(start)));
    return norm(way) > least_way * norm(apart_) ? dot(apart_, way) : 0;
  }

  /// After make(): whether the nearest points lie beyond each other at the start, along the normal.
  /// Surfaces do not cross there, so that one has come to the other's back by then: the touch would
  /// hold it there.
  TETWARP_ANY_EXEC bool is_from_behind() const { return apart_at_start_ < 0; }

  /// After make(): the distance of the features at the time of the touch if both sides were moved.
  TETWARP_ANY_EXEC double distance_moved(const Vec3& move_a, const Vec3& move_b) const {
    Vec3 x[4];
    int count = 0;
    for (int k = 0; k < 3 && a_.vertex[k] >= 0; ++k) x[count++] = plus(place(a_.vertex[k]), move_a);
    for (int k = 0; k < 3 && b_.vertex[k] >= 0; ++k) x[count++] = plus(place(b_.vertex[k]), move_b);
    const double radius = a_.radius + b_.radius;
    double weight[3];
    switch (touch_.kind) {
      case PairKind::vertex_face:
        return vertex_face_distance(x[0].x, x[1].x, x[2].x, x[3].x, weight) - radius;
      case PairKind::edge_edge:
        return edge_edge_distance(x[0].x, x[1].x, x[2].x, x[3].x, weight, weight + 1) - radius;
      case PairKind::vertex_edge:
        return std::sqrt(vertex_edge_square(x[0].x, x[1].x, x[2].x, weight)) - radius;
      default:
        return norm(minus(x[0], x[1])) - radius;
    }
  }

  /// Whether two capsules are side by side, to 10 degrees.
  /// @param part  out, of any two capsules: [2] fractions of axis a between which the axes overlap
  TETWARP_ANY_EXEC bool overlaps(double* part) const {
    constexpr double parallel_sine = 0.17364817766693033;  // of 10 degrees
    if (!touch_.is_of_edges() || view_.scene.edge_radius[touch_.a] == 0 ||
        view_.scene.edge_radius[touch_.b] == 0) {
      return false;
    }
    const std::int32_t *const p = view_.edge(touch_.a), *const q = view_.edge(touch_.b);
    const Vec3 from = place(p[0]), along = minus(place(p[1]), from);
    const Vec3 begin = place(q[0]), end = place(q[1]), other = minus(end, begin);
    const double square = dot(along, along);
    const double s0 = dot(along, minus(begin, from)) / square;
    const double s1 = dot(along, minus(end, from)) / square;
    part[0] = max_of(0.0, min_of(s0, s1));
    part[1] = min_of(1.0, max_of(s0, s1));
    return part[1] - part[0] > 1e-6 &&
           !(norm(cross(along, other)) > parallel_sine * std::sqrt(square) * norm(other));
  }
  /// At a fraction s of axis a of two capsules.
  TETWARP_ANY_EXEC PairTouch make_at(double s, std::int32_t end) {
    touch_.end = end;
    const std::int32_t *const p = view_.edge(touch_.a), *const q = view_.edge(touch_.b);
    const Vec3 x = lerp(place(p[0]), place(p[1]), s), q0 = place(q[0]), q1 = place(q[1]);
    double t = 0;
    vertex_edge_square(x.x, q0.x, q1.x, &t);
    set_edge(a_, touch_.a, s, touch_.body_a, hit_a_);
    set_edge(b_, touch_.b, t, touch_.body_b, hit_b_);
    apart_ = minus(hit_a_, hit_b_);
    otherwise_ = any_across(minus(q1, q0));
    const View<const double> start = view_.motion.start;
    touch_.distance = norm(minus(a_.mean(start), b_.mean(start))) - a_.radius - b_.radius;
    finish();
    return touch_;
  }

 private:
  /// Place of a vertex at the hit, relative to the start of the pair's first vertex: far from the
  /// origin of the world no digits of distances are lost.
  TETWARP_HD Vec3 place(std::int32_t vertex) const {
    const Vec3 start = view_.start(vertex), end = vec3_at(view_.motion.end, vertex);
    const TurningFrame* const frame = view_.motion.frame_of(view_.scene.vertex_body[vertex]);
    return plus(minus(start, origin_), way_at(frame, start, end, time_));
  }

  /// The vertices of a side whose weights are not 0.
  struct Corners {
    std::int32_t vertex[3];
    int count = 0;
  };
  TETWARP_HD static Corners corners_of(const SidePoint& side) {
    Corners own = {};
    for (int k = 0; k < 3 && side.vertex[k] >= 0; ++k) {
      if (side.weight[k] > 0) own.vertex[own.count++] = side.vertex[k];
    }
    return own;
  }
  /// The surface of a body that turns is that of the start, seen from its frame.
  TETWARP_HD const TurningFrame* frame_at_touch(std::int32_t body) const {
    return time_ > 0 ? view_.motion.frame_of(body) : nullptr;
  }
  TETWARP_HD VerticesAt vertices_at_touch(const TurningFrame* frame) const {
    return {view_.motion.start, view_.motion.end, frame != nullptr ? 0 : time_};
  }

  /// @param toward  the other side, from this one
  TETWARP_ANY_EXEC bool is_nearest_of(const SidePoint& side,
                                      std::int32_t body,
                                      const Vec3& toward) const {
    const Corners own = corners_of(side);
    if (own.count > 2 || side.radius > 0) return true;
    const bool gives_way = view_.moves(body) && !view_.is_rigid(body);
    if (gives_way && touch_.is_of_face()) return true;
    const double sine = !(time_ > 0)                        ? sine_3
                        : gives_way && touch_.is_of_edges() ? sine_20
                                                            : half_sine;
    const TurningFrame* const frame = frame_at_touch(body);
    const Vec3 other = frame != nullptr ? turned(*frame, -time_, toward) : toward;
    const VerticesAt vertices = vertices_at_touch(frame);
    return own.count == 2 ? edge_is_nearest(view_.areas, own.vertex, other, vertices, sine)
                          : vertex_is_nearest(view_.areas, own.vertex[0], other, vertices, sine);
  }

  TETWARP_ANY_EXEC void set_vertex(SidePoint& side,
                                   std::int32_t vertex,
                                   std::int32_t& body,
                                   Vec3& hit) const {
    side.vertex[0] = vertex;
    side.weight[0] = 1;
    side.radius = view_.scene.vertex_radius[vertex];
    body = view_.scene.vertex_body[vertex];
    hit = place(vertex);
  }
  TETWARP_ANY_EXEC void set_edge(
      SidePoint& side, std::int32_t edge, double s, std::int32_t& body, Vec3& hit) const {
    const std::int32_t* const ends = view_.edge(edge);
    for (int k = 0; k < 2; ++k) side.vertex[k] = ends[k];
    side.weight[0] = 1 - s;
    side.weight[1] = s;
    side.radius = view_.scene.edge_radius[edge];
    body = view_.scene.vertex_body[ends[0]];
    hit = lerp(place(ends[0]), place(ends[1]), s);
  }

  TETWARP_ANY_EXEC void vertex_face() {
    set_vertex(a_, touch_.a, touch_.body_a, hit_a_);
    const std::int32_t* const corner = view_.areas.corners.data + 3 * std::int64_t{touch_.b};
    for (int k = 0; k < 3; ++k) b_.vertex[k] = corner[k];
    touch_.body_b = view_.scene.vertex_body[corner[0]];
    const Vec3 x0 = place(corner[0]), x1 = place(corner[1]), x2 = place(corner[2]);
    double* const weight = b_.weight;
    vertex_face_distance(hit_a_.x, x0.x, x1.x, x2.x, weight);
    touch_.is_inside = weight[0] > 0 && weight[1] > 0 && weight[2] > 0;
    hit_b_ = plus(x0, plus(times(weight[1], minus(x1, x0)), times(weight[2], minus(x2, x0))));
    // A vertex exactly on a face is on its outer side.
    apart_ = minus(hit_a_, hit_b_);
    if (!(norm(apart_) > 0)) apart_ = unit(cross(minus(x1, x0), minus(x2, x0)));
  }
  TETWARP_ANY_EXEC void edge_edge() {
    const std::int32_t *const p = view_.edge(touch_.a), *const q = view_.edge(touch_.b);
    const Vec3 p0 = place(p[0]), p1 = place(p[1]), q0 = place(q[0]), q1 = place(q[1]);
    double s = 0, t = 0;
    edge_edge_distance(p0.x, p1.x, q0.x, q1.x, &s, &t);
    set_edge(a_, touch_.a, s, touch_.body_a, hit_a_);
    set_edge(b_, touch_.b, t, touch_.body_b, hit_b_);
    apart_ = minus(hit_a_, hit_b_);
    otherwise_ = cross(minus(p1, p0), minus(q1, q0));
    if (!(norm(otherwise_) > 0)) otherwise_ = any_across(minus(p1, p0));
    // Where an end of an edge is nearest, its vertex has a pair with the other surface, and that
    // one counts. Two capsules have no such pair, nor has a corner against the side of a capsule.
    const bool ends_a = s <= 0 || s >= 1, ends_b = t <= 0 || t >= 1;
    const bool is_round_a = a_.radius > 0, is_round_b = b_.radius > 0;
    touch_.is_inside = (is_round_a && is_round_b) || (!(ends_a && (is_round_a || !is_round_b)) &&
                                                      !(ends_b && (is_round_b || !is_round_a)));
  }
  TETWARP_ANY_EXEC void vertex_edge() {
    set_vertex(a_, touch_.a, touch_.body_a, hit_a_);
    const std::int32_t* const q = view_.edge(touch_.b);
    const Vec3 q0 = place(q[0]), q1 = place(q[1]);
    double s = 0;
    vertex_edge_square(hit_a_.x, q0.x, q1.x, &s);
    set_edge(b_, touch_.b, s, touch_.body_b, hit_b_);
    apart_ = minus(hit_a_, hit_b_);
    otherwise_ = any_across(minus(q1, q0));
    touch_.is_inside = s > 0 && s < 1;
  }
  TETWARP_ANY_EXEC void vertex_vertex() {
    set_vertex(a_, touch_.a, touch_.body_a, hit_a_);
    set_vertex(b_, touch_.b, touch_.body_b, hit_b_);
    apart_ = minus(hit_a_, hit_b_);
  }

  TETWARP_ANY_EXEC void finish() {
    const Vec3 start_a = a_.mean(view_.motion.start), start_b = b_.mean(view_.motion.start);
    touch_.normal = direction_ = normal_at(minus(start_a, start_b));
    if (a_.radius + b_.radius == 0) lean_on_faces();
    touch_.point_a = minus(start_a, times(a_.radius, touch_.normal));
    touch_.point_b = plus(start_b, times(b_.radius, touch_.normal));
    touch_.way =
        minus(minus(a_.mean(view_.first_end), start_a), minus(b_.mean(view_.first_end), start_b));
    set_gap(start_a, start_b);
  }
  /// Where one side cannot give way and one of its faces around the touch leans by at most 3
  /// degrees from the normal, takes the face's normal. What slides over the edges of level faces so
  /// is not slowed down, however little it is turned against them.
  TETWARP_ANY_EXEC void lean_on_faces() {
    if (!view_.moves(touch_.body_b)) {
      touch_.normal = face_normal_near(b_, touch_.body_b, touch_.normal);
    } else if (!view_.moves(touch_.body_a)) {
      touch_.normal = times(-1, face_normal_near(a_, touch_.body_a, times(-1, touch_.normal)));
    }
  }
  /// The normal of the face around the nearest point of a side that is nearest to a direction, to 3
  /// degrees; else the direction. Inside a face that is the direction.
  TETWARP_ANY_EXEC Vec3 face_normal_near(const SidePoint& side,
                                         std::int32_t body,
                                         const Vec3& direction) const {
    const Corners own = corners_of(side);
    if (own.count > 2) return direction;
    const TurningFrame* const frame = frame_at_touch(body);
    const Vec3 toward = frame != nullptr ? turned(*frame, -time_, direction) : direction;
    const Vec3 normal = nearest_face_normal(view_.areas, own.vertex, own.count, toward,
                                            vertices_at_touch(frame), cosine_3);
    return frame != nullptr ? turned(*frame, time_, normal) : normal;
  }

  /// The unit vector along `apart_`; where it vanishes, along or against `otherwise_`.
  /// @param start  apart at the start of the motion; the result points to the same side
  TETWARP_HD Vec3 normal_at(const Vec3& start) const {
    if (norm(apart_) > 0) return unit(apart_);
    const Vec3 normal = norm(otherwise_) > 0 ? unit(otherwise_) : Vec3{{0, 0, 1}};
    return dot(normal, start) < 0 ? times(-1, normal) : normal;
  }

  TETWARP_ANY_EXEC void vertex_plane() {
    set_vertex(a_, touch_.a, touch_.body_a, hit_a_);
    const std::int64_t plane = 6 * std::int64_t{touch_.b};
    const double *const before = view_.motion.plane_start.data + plane,
                        *const after = view_.motion.plane_end.data + plane;
    const Vec3 point = vec3_of(before), normal = vec3_of(before + 3);
    touch_.body_b = view_.scene.plane_body[touch_.b];
    const TurningFrame* const frame = view_.motion.frame_of(touch_.body_b);
    touch_.normal = frame != nullptr ? turned(*frame, time_, normal)
                                     : unit(lerp(normal, vec3_of(after + 3), time_));
    const Vec3 start_a = view_.start(touch_.a);
    touch_.point_a = minus(start_a, times(a_.radius, touch_.normal));
    // The foot of the vertex on the plane at the hit, as a material point of the plane: turned back
    // to the start.
    const Vec3 place = plus(minus(point, origin_), way_at(frame, point, vec3_of(after), time_));
    const Vec3 arm = minus(hit_a_, place);
    const Vec3 foot = minus(arm, times(dot(arm, touch_.normal), touch_.normal));
    touch_.point_b =
        plus(point, frame != nullptr ? turned(*frame, -time_, foot) : turned_back(foot, normal));
    const Vec3 first_end = vec3_of(view_.first_plane_end.data + plane);
    touch_.way = minus(minus(a_.mean(view_.first_end), a_.mean(view_.motion.start)),
                       minus(first_end, point));
    set_gap(start_a, touch_.point_b);
  }
  /// The foot turned back on a plane without a frame: by the smallest rotation that takes the
  /// normal back.
  TETWARP_ANY_EXEC Vec3 turned_back(const Vec3& foot, const Vec3& before) const {
    const Vec3 axis = cross(touch_.normal, before);
    const double cosine = dot(touch_.normal, before);
    if (!(cosine > -0.5)) return foot;
    return plus(times(cosine, foot),
                plus(cross(axis, foot), times(dot(axis, foot) / (1 + cosine), axis)));
  }

  /// By how much the way of a point over the motion differs from its velocity at the start, with
  /// which contacts are solved: a body that turns takes its points along arcs.
  TETWARP_ANY_EXEC Vec3 bend_of(std::int32_t body, const Vec3& start) const {
    const TurningFrame* const frame = view_.motion.frame_of(body);
    if (frame == nullptr) return {};
    const Vec3 arm = minus(start, vec3_of(frame->center));
    return minus(minus(turned(*frame, 1, arm), arm), cross(vec3_of(frame->turn), arm));
  }

  /// Sets the gap and moves the points along the normal until they are `gap` apart. Of surfaces
  /// that are near at the start, and in detections after the first, the gap is reduced by as much
  /// as the bend of the ways brings them nearer. Otherwise a body that rolls and turns would come
  /// nearer by that in every step, by more than the thickness, although its contacts are solved.
  /// @param start_a, start_b  the nearest points, without radii
  TETWARP_ANY_EXEC void set_gap(const Vec3& start_a, const Vec3& start_b) {
    for (int k = 0; k < 3; ++k) {
      touch_.vertex_a[k] = a_.vertex[k];
      touch_.weight_a[k] = a_.weight[k];
      touch_.vertex_b[k] = b_.vertex[k];
      touch_.weight_b[k] = b_.weight[k];
    }
    const double apart = dot(touch_.normal, minus(touch_.point_a, touch_.point_b));
    apart_at_start_ = apart;
    touch_.gap = apart - view_.thickness;
    // Surfaces that are apart at the start have no negative gap, however far the normal turns until
    // the hit.
    if (touch_.distance >= view_.thickness) touch_.gap = max_of(touch_.gap, 0.0);
    if (touch_.pass > 0 || touch_.distance < 2 * view_.thickness) {
      const Vec3 bend = minus(bend_of(touch_.body_a, start_a), bend_of(touch_.body_b, start_b));
      const double dip = min_of(dot(touch_.normal, bend), 0.0);
      touch_.gap += dip;
      touch_.way = minus(touch_.way, times(dip, touch_.normal));  // which contains it, too
    }
    const double extra = apart - touch_.gap, share_a = share_of_a();
    touch_.point_a = minus(touch_.point_a, times(share_a * extra, touch_.normal));
    touch_.point_b = plus(touch_.point_b, times((1 - share_a) * extra, touch_.normal));
  }
  /// The part of the correction that moves point a. Opposite impulses at two points apart would
  /// turn bodies: so a rigid side uses the point of a deformable one. A side that does not move may
  /// use any point.
  TETWARP_HD double share_of_a() const {
    const bool moves_a = view_.moves(touch_.body_a), moves_b = view_.moves(touch_.body_b);
    if (moves_a != moves_b) return moves_a ? 0 : 1;
    const bool is_rigid_a = view_.is_rigid(touch_.body_a);
    if (is_rigid_a != view_.is_rigid(touch_.body_b)) return is_rigid_a ? 1 : 0;
    return 0.5;
  }

  // By how much the direction between nearest points may lean over a surface around them. At a hit
  // with speed v a leaning normal costs v times the sine along the surface. In the expected motion
  // parts of a deformable body may be through the other surface already, and lead their neighbors:
  // its edges may lean more, and its vertices on faces by any angle.
  static constexpr double half_sine = 0.0087265354983739;  ///< of 0.5 degrees: hits
  static constexpr double sine_3 = 0.0523359562429438;     ///< of 3 degrees: near at the start
  static constexpr double cosine_3 = 0.9986295347545738;
  static constexpr double sine_20 = 0.3420201433256687;  ///< of 20 degrees
  static constexpr double least_way = 0.1;  ///< distances: shorter ways do not turn normals

  const TouchView& view_;
  double time_;  ///< of the hit; 0 where the pair is near but not hit
  PairTouch touch_;
  SidePoint a_, b_;
  Vec3 origin_{};
  Vec3 hit_a_{}, hit_b_{};  ///< relative to origin_, without radii
  Vec3 apart_{}, otherwise_{{0, 0, 1}};
  double apart_at_start_ = 0;  ///< along the normal, without radii
  Vec3 direction_{{0, 0, 1}};  ///< unit, between the nearest points: the normal before it leans
};

}  // namespace tetwarp

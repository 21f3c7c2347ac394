#include "host/simulate/contact/pair_touch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "host/simulate/contact/side_point.hpp"
#include "host/simulate/contact/turning_frame.hpp"
#include "kernels/collide/pair_distance.hpp"

namespace tetwarp {
namespace {

constexpr double parallel_sine = 0.17364817766693033;  // of 10 degrees

/// A pair of two sides of vertices at the time of its hit.
class TouchMaker {
 public:
  TouchMaker(const TouchingPair& pair,
             const SceneSurfaces& scene,
             const SurfaceMotion& motion,
             const SurfaceMotion& first)
      : scene_(scene), motion_(motion), first_(first), time_(pair.time <= 1 ? pair.time : 0) {
    touch_.kind = pair.kind;
    touch_.a = pair.a;
    touch_.b = pair.b;
    touch_.distance = pair.start_distance;
    const bool is_near = pair.start_distance < 2 * scene.surfaces.thickness;
    touch_.time = is_near ? 0 : time_;
    if (time_ > 0) {
      const bool is_edge = pair.kind == PairKind::edge_edge;
      origin_ = at(motion.start.vertices, is_edge ? at(scene.surfaces.edges, pair.a)[0] : pair.a);
    }
  }

  PairTouch make() {
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

  /// Of two capsules that overlap side by side.
  std::optional<std::array<double, 2>> overlap() const {
    if (touch_.kind != PairKind::edge_edge) return std::nullopt;
    const auto &p = at(surfaces().edges, touch_.a), &q = at(surfaces().edges, touch_.b);
    if (at(surfaces().edge_radius, touch_.a) == 0 || at(surfaces().edge_radius, touch_.b) == 0) {
      return std::nullopt;
    }
    const Point3 along = minus(place(p[1]), place(p[0])), other = minus(place(q[1]), place(q[0]));
    const double square = dot(along, along);
    if (norm(cross(along, other)) > parallel_sine * std::sqrt(square) * norm(other)) {
      return std::nullopt;
    }
    const double s0 = dot(along, minus(place(q[0]), place(p[0]))) / square;
    const double s1 = dot(along, minus(place(q[1]), place(p[0]))) / square;
    const std::array<double, 2> part{std::max(0.0, std::min(s0, s1)),
                                     std::min(1.0, std::max(s0, s1))};
    if (!(part[1] - part[0] > 1e-6)) return std::nullopt;
    return part;
  }
  /// At a fraction s of axis a of two capsules.
  PairTouch make_at(double s, std::int32_t end) {
    touch_.end = end;
    const auto &p = at(surfaces().edges, touch_.a), &q = at(surfaces().edges, touch_.b);
    const Point3 x = lerp(place(p[0]), place(p[1]), s), q0 = place(q[0]), q1 = place(q[1]);
    double t = 0;
    vertex_edge_square(x.data(), q0.data(), q1.data(), &t);
    set_edge(a_, touch_.a, s, touch_.body_a, hit_a_);
    set_edge(b_, touch_.b, t, touch_.body_b, hit_b_);
    apart_ = minus(hit_a_, hit_b_);
    otherwise_ = any_across(minus(q1, q0));
    touch_.distance =
        norm(minus(mean_of(a_, motion_.start.vertices), mean_of(b_, motion_.start.vertices))) -
        a_.radius - b_.radius;
    finish();
    return touch_;
  }

 private:
  const CollisionSurfaces& surfaces() const { return scene_.surfaces; }
  /// At the hit. On the way relative to where the first vertex of the pair starts: far from zero no
  /// digits of distances are lost.
  Point3 place(std::int32_t vertex) const {
    const Point3& start = at(motion_.start.vertices, vertex);
    const TurningFrame* frame = frame_of(motion_, at(surfaces().vertex_body, vertex));
    return plus(minus(start, origin_),
                way_at(frame, start, at(motion_.end.vertices, vertex), time_));
  }

  void set_vertex_a() {
    a_.vertex[0] = touch_.a;
    a_.weight[0] = 1;
    a_.radius = at(surfaces().vertex_radius, touch_.a);
    touch_.body_a = at(surfaces().vertex_body, touch_.a);
    hit_a_ = place(touch_.a);
  }
  void set_edge(SidePoint& side, std::int32_t edge, double s, std::int32_t& body, Point3& hit) {
    const auto& [v0, v1] = at(surfaces().edges, edge);
    side.vertex = {v0, v1, -1};
    side.weight = {1 - s, s, 0};
    side.radius = at(surfaces().edge_radius, edge);
    body = at(surfaces().vertex_body, v0);
    hit = lerp(place(v0), place(v1), s);
  }

  void vertex_face() {
    set_vertex_a();
    b_.vertex = at(surfaces().triangles, touch_.b);
    touch_.body_b = at(surfaces().vertex_body, b_.vertex[0]);
    const Point3 x0 = place(b_.vertex[0]), x1 = place(b_.vertex[1]), x2 = place(b_.vertex[2]);
    vertex_face_distance(hit_a_.data(), x0.data(), x1.data(), x2.data(), b_.weight.data());
    touch_.is_inside = *std::min_element(b_.weight.begin(), b_.weight.end()) > 0;
    hit_b_ = plus(x0, plus(times(b_.weight[1], minus(x1, x0)), times(b_.weight[2], minus(x2, x0))));
    // A vertex exactly on a face is on its outer side.
    apart_ = minus(hit_a_, hit_b_);
    if (!(norm(apart_) > 0)) apart_ = unit(cross(minus(x1, x0), minus(x2, x0)));
    otherwise_ = {0, 0, 1};
  }
  void edge_edge() {
    const auto& [p0, p1] = at(surfaces().edges, touch_.a);
    const auto& [q0, q1] = at(surfaces().edges, touch_.b);
    const Point3 p[2] = {place(p0), place(p1)}, q[2] = {place(q0), place(q1)};
    double s = 0, t = 0;
    edge_edge_distance(p[0].data(), p[1].data(), q[0].data(), q[1].data(), &s, &t);
    set_edge(a_, touch_.a, s, touch_.body_a, hit_a_);
    set_edge(b_, touch_.b, t, touch_.body_b, hit_b_);
    apart_ = minus(hit_a_, hit_b_);
    otherwise_ = cross(minus(p[1], p[0]), minus(q[1], q[0]));
    if (!(norm(otherwise_) > 0)) otherwise_ = any_across(minus(p[1], p[0]));
    // An end that touches is a vertex that touches a face, of which there is another pair. There is
    // none of two capsules, nor of a corner against the side of a capsule.
    const bool ends_a = s <= 0 || s >= 1, ends_b = t <= 0 || t >= 1;
    const bool is_round_a = a_.radius > 0, is_round_b = b_.radius > 0;
    touch_.is_inside = (is_round_a && is_round_b) || (!(ends_a && (is_round_a || !is_round_b)) &&
                                                      !(ends_b && (is_round_b || !is_round_a)));
  }
  void vertex_edge() {
    set_vertex_a();
    const auto& [q0, q1] = at(surfaces().edges, touch_.b);
    const Point3 q[2] = {place(q0), place(q1)};
    double s = 0;
    vertex_edge_square(hit_a_.data(), q[0].data(), q[1].data(), &s);
    set_edge(b_, touch_.b, s, touch_.body_b, hit_b_);
    apart_ = minus(hit_a_, hit_b_);
    otherwise_ = any_across(minus(q[1], q[0]));
    touch_.is_inside = s > 0 && s < 1;
  }
  void vertex_vertex() {
    set_vertex_a();
    b_.vertex[0] = touch_.b;
    b_.weight[0] = 1;
    b_.radius = at(surfaces().vertex_radius, touch_.b);
    touch_.body_b = at(surfaces().vertex_body, touch_.b);
    hit_b_ = place(touch_.b);
    apart_ = minus(hit_a_, hit_b_);
    otherwise_ = {0, 0, 1};
  }

  void finish() {
    const Point3 start_a = mean_of(a_, motion_.start.vertices);
    const Point3 start_b = mean_of(b_, motion_.start.vertices);
    touch_.normal = normal_of(apart_, otherwise_, minus(start_a, start_b));
    touch_.point_a = minus(start_a, times(a_.radius, touch_.normal));
    touch_.point_b = plus(start_b, times(b_.radius, touch_.normal));
    touch_.way = minus(way_of(a_, first_), way_of(b_, first_));
    touch_.material_b = material_of(b_, scene_, touch_.body_b);
    touch_.part_b = b_.vertex;
    for (std::size_t k = 0; k < 3; ++k) {
      if (b_.weight[k] > 0) touch_.nearest_b[k] = b_.vertex[k];
    }
    set_gap();
  }

  void vertex_plane() {
    set_vertex_a();
    const PlanePlace& before = at(motion_.start.planes, touch_.b);
    const PlanePlace& after = at(motion_.end.planes, touch_.b);
    touch_.body_b = at(surfaces().plane_body, touch_.b);
    const TurningFrame* frame = frame_of(motion_, touch_.body_b);
    touch_.normal = frame != nullptr ? turned(*frame, time_, before.normal)
                                     : unit(lerp(before.normal, after.normal, time_));
    const Point3 start_a = at(motion_.start.vertices, touch_.a);
    touch_.point_a = minus(start_a, times(a_.radius, touch_.normal));
    // The vertex's foot at the hit, in the material of the plane: turned back as the plane turned.
    const Point3 place =
        plus(minus(before.point, origin_), way_at(frame, before.point, after.point, time_));
    const Point3 arm = minus(hit_a_, place);
    const Point3 foot = minus(arm, times(dot(arm, touch_.normal), touch_.normal));
    touch_.point_b = plus(before.point, frame != nullptr ? turned(*frame, -time_, foot)
                                                         : turned_back(foot, before.normal));
    const PlanePlace& first_start = at(first_.start.planes, touch_.b);
    const PlanePlace& first_end = at(first_.end.planes, touch_.b);
    touch_.way = minus(way_of(a_, first_), minus(first_end.point, first_start.point));
    set_gap();
  }

  /// Of a plane without a frame: by the least rotation that takes the normal back.
  Point3 turned_back(const Point3& foot, const Point3& before) const {
    const Point3 axis = cross(touch_.normal, before);
    const double cosine = dot(touch_.normal, before);
    if (!(cosine > -0.5)) return foot;
    return plus(times(cosine, foot),
                plus(cross(axis, foot), times(dot(axis, foot) / (1 + cosine), axis)));
  }

  /// Sets the gap and moves the points along the normal to be as far apart.
  void set_gap() {
    touch_.material_a = material_of(a_, scene_, touch_.body_a);
    const double apart = dot(touch_.normal, minus(touch_.point_a, touch_.point_b));
    touch_.gap = apart - surfaces().thickness;
    // Surfaces that are apart do not overlap, however far the normal turns until the hit.
    if (touch_.distance >= surfaces().thickness) touch_.gap = std::max(touch_.gap, 0.0);
    const double extra = apart - touch_.gap;
    const double share_a = share_of_a();
    touch_.point_a = minus(touch_.point_a, times(share_a * extra, touch_.normal));
    touch_.point_b = plus(touch_.point_b, times((1 - share_a) * extra, touch_.normal));
  }

  /// Impulses at points that are apart would turn bodies: a rigid side gets the point at which the
  /// other side is hit; one that does not move can have any.
  double share_of_a() const {
    const bool moves_a = at(surfaces().bodies, touch_.body_a).has_unknowns;
    const bool moves_b = at(surfaces().bodies, touch_.body_b).has_unknowns;
    if (moves_a != moves_b) return moves_a ? 0 : 1;
    const bool is_rigid_a = at(scene_.is_rigid, touch_.body_a) != 0;
    const bool is_rigid_b = at(scene_.is_rigid, touch_.body_b) != 0;
    if (is_rigid_a != is_rigid_b) return is_rigid_a ? 1 : 0;
    return 0.5;
  }

  const SceneSurfaces& scene_;
  const SurfaceMotion& motion_;
  const SurfaceMotion& first_;
  double time_ = 0;  ///< of the hit; 0 where it is near only
  PairTouch touch_;
  SidePoint a_, b_;
  Point3 origin_{0, 0, 0};
  Point3 hit_a_{0, 0, 0}, hit_b_{0, 0, 0};  ///< from the origin, without radii
  Point3 apart_{0, 0, 0}, otherwise_{0, 0, 1};
};
}  // namespace

PairTouch touch_of(const TouchingPair& pair,
                   const SceneSurfaces& scene,
                   const SurfaceMotion& motion,
                   const SurfaceMotion& first) {
  return TouchMaker(pair, scene, motion, first).make();
}

std::optional<std::array<PairTouch, 2>> end_touches_of(const TouchingPair& pair,
                                                       const SceneSurfaces& scene,
                                                       const SurfaceMotion& motion,
                                                       const SurfaceMotion& first) {
  const TouchMaker maker(pair, scene, motion, first);
  const auto part = maker.overlap();
  if (!part) return std::nullopt;
  TouchMaker at_begin = maker, at_end = maker;
  return std::array{at_begin.make_at((*part)[0], 1), at_end.make_at((*part)[1], 2)};
}

}  // namespace tetwarp

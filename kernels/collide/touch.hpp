/// @file touch.hpp
/// Where and in which direction two features touch.
#pragma once
#include <cstdint>

#include "kernels/base/vec3.hpp"
#include "kernels/collide/collide_item.hpp"
#include "kernels/collide/pair_kind.hpp"
#include "kernels/collide/touch_area.hpp"

namespace tetwarp {

constexpr double cosine_5 = 0.9961946980917455;   ///< normals that are the same: at least
constexpr double cosine_45 = 0.7071067811865476;  ///< parts that face elsewhere: less

/// The touch of a pair of features. Side a is that of the first feature. A touch with `counts` =
/// false becomes no contact; it only replaces earlier touches of its pair.
struct PairTouch {
  PairKind kind = PairKind::vertex_face;
  bool counts = true;     ///< false: edges that touch at an end, or features that are not what is
                          ///< nearest of their surfaces, or what other contacts forbid
  bool is_hit = false;    ///< hit, by features that are what is nearest of their surfaces then
  bool has_ends = false;  ///< capsules side by side, which also touch at both ends of their overlap
  bool is_inside = true;  ///< nearest point inside a face; of two edges: between all ends
  std::int32_t a = 0, b = 0;  ///< the features, as in TouchingPair
  std::int32_t end = 0;       ///< 1, 2: at an end of the overlap of two capsules side by side
  std::int32_t pass = 0;      ///< the detection of the step that found it, from 0
  std::int32_t body_a = 0, body_b = 0;  ///< bodies, then obstacles
  Vec3 point_a{}, point_b{};  ///< material points at the start, `gap` apart along the normal
  Vec3 normal{{0, 0, 1}};     ///< unit, from b to a
  Vec3 way{};           ///< displacement of a relative to b in the first motion of the step [m]
  double gap = 0;       ///< at the start along the normal, less the thickness [m]
  double distance = 0;  ///< between the surfaces at the start [m]
  double time = 0;      ///< of the hit, 0 to 1; 0 where they are near at the start
  std::int32_t vertex_a[3] = {-1, -1, -1};    ///< of the vertex or edge a; -1: not used
  std::int32_t vertex_b[3] = {-1, -1, -1};    ///< of the face, edge or vertex b; none of a plane
  double weight_a[3] = {}, weight_b[3] = {};  ///< their weights in the nearest points; sum 1

  TETWARP_HD bool is_of_edges() const { return kind == PairKind::edge_edge; }
  /// Whether the normal is that of a face or a plane, so that it stays as side a slides over it.
  TETWARP_HD bool is_of_face() const {
    return kind == PairKind::vertex_plane || (kind == PairKind::vertex_face && is_inside);
  }
  bool operator==(const PairTouch&) const = default;
};

/// A touch that becomes a contact.
struct ChosenTouch {
  PairTouch touch;
  double area;  ///< that touches [m^2]
};

/// Surfaces and their motion as the stages of touches read them.
struct TouchView {
  CollideView scene;
  TouchAreaView areas;
  MotionView motion;             ///< in which the pairs were found
  View<const double> first_end;  ///< of the first motion of the step, as MotionView
  View<const double> first_plane_end;
  double thickness;  ///< [m]

  TETWARP_HD Vec3 start(std::int32_t vertex) const { return vec3_at(motion.start, vertex); }
  TETWARP_HD const std::int32_t* edge(std::int32_t e) const {
    return scene.edges.data + 2 * std::int64_t{e};
  }
  TETWARP_HD bool is_rigid(std::int32_t body) const { return scene.bodies[body].is_rigid != 0; }
  TETWARP_HD bool moves(std::int32_t body) const { return scene.bodies[body].has_unknowns != 0; }
};

/// A point of one side of a pair, as a weighted mean of up to three vertices.
struct SidePoint {
  std::int32_t vertex[3] = {-1, -1, -1};
  double weight[3] = {};
  double radius = 0;

  TETWARP_HD Vec3 mean(View<const double> vertices) const {
    Vec3 sum{};
    for (int k = 0; k < 3 && vertex[k] >= 0; ++k) {
      sum = plus(sum, times(weight[k], vec3_at(vertices, vertex[k])));
    }
    return sum;
  }
};

/// exp(time turn) of a direction.
TETWARP_ANY_EXEC inline Vec3 turned(const TurningFrame& frame, double time, const Vec3& direction) {
  const Vec3 turn = vec3_of(frame.turn);
  const double angle = norm(turn), half = std::sin(time * angle / 2);
  const Vec3 axis = times(1 / angle, turn);
  const Vec3 once = cross(axis, direction), twice = cross(axis, once);
  return plus(direction, plus(times(std::sin(time * angle), once), times(2 * half * half, twice)));
}

/// Displacement of a point of a body from the start to a time of the motion.
/// @param frame  that the body follows, or null: the point moves straight
TETWARP_HD Vec3 way_at(const TurningFrame* frame, const Vec3& start, const Vec3& end, double time) {
  if (frame == nullptr) return times(time, minus(end, start));
  const Vec3 arm = minus(start, vec3_of(frame->center));
  return plus(times(time, vec3_of(frame->motion)), minus(turned(*frame, time, arm), arm));
}

}  // namespace tetwarp

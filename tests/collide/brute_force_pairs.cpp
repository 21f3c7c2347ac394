#include "tests/collide/brute_force_pairs.hpp"

#include <algorithm>
#include <functional>
#include <initializer_list>

#include "kernels/collide/pair_ccd.hpp"
#include "kernels/collide/plane_ccd.hpp"

namespace tetwarp::test {
namespace {
using Index = std::int32_t;

class AllPairs {
 public:
  explicit AllPairs(const CollideScene& scene) : s_(scene.surfaces), motion_(scene.motion) {}

  /// call(kind, a, b, points) of every pair of features that may touch.
  template <class Call>
  void for_each(const Call& call) {
    const Index vertices = count_of(s_.vertex_body), edges = count_of(s_.edges);
    for (Index v = 0; v < vertices; ++v) {
      for (Index t = 0; t < count_of(s_.triangles); ++t) {
        const auto& c = s_.triangles[at(t)];
        if (may_touch(v, c[0]) && differ({v}, {c[0], c[1], c[2]})) {
          call(PairKind::vertex_face, v, t,
               points({v}, {c[0], c[1], c[2]}, s_.vertex_radius[at(v)]));
        }
      }
      for (Index p = 0; p < count_of(s_.plane_body); ++p) {
        if (bodies_may_touch(s_.vertex_body[at(v)], s_.plane_body[at(p)])) {
          call(PairKind::vertex_plane, v, p, points({v}, {}, s_.vertex_radius[at(v)]));
        }
      }
    }
    for (Index e = 0; e < edges; ++e) {
      for (Index f = e + 1; f < edges; ++f) {
        const auto &a = s_.edges[at(e)], &b = s_.edges[at(f)];
        if (may_touch(a[0], b[0]) && differ({a[0], a[1]}, {b[0], b[1]})) {
          call(PairKind::edge_edge, e, f,
               points({a[0], a[1]}, {b[0], b[1]}, s_.edge_radius[at(e)] + s_.edge_radius[at(f)]));
        }
      }
    }
    for (Index v = 0; v < vertices; ++v) {
      if (!is_sphere(v)) continue;
      const double radius = s_.vertex_radius[at(v)];
      for (Index e = 0; e < edges; ++e) {
        const auto& b = s_.edges[at(e)];
        if (s_.edge_radius[at(e)] > 0 && may_touch(v, b[0]) && differ({v}, {b[0], b[1]})) {
          call(PairKind::vertex_edge, v, e,
               points({v}, {b[0], b[1]}, radius + s_.edge_radius[at(e)]));
        }
      }
      for (Index w = v + 1; w < vertices; ++w) {
        if (is_sphere(w) && may_touch(v, w)) {
          call(PairKind::vertex_vertex, v, w, points({v}, {w}, radius + s_.vertex_radius[at(w)]));
        }
      }
    }
  }

  CcdResult ccd(PairKind kind, Index b, const MovingPoints& points, const CcdLimits& limits) const {
    switch (kind) {
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
    const PlanePlace &start = motion_.start.planes[at(b)], &end = motion_.end.planes[at(b)];
    return vertex_plane_ccd(points,
                            {start.point.data(), start.normal.data(), end.point.data(),
                             end.normal.data(), frame_of(s_.plane_body[at(b)])},
                            limits);
  }

 private:
  const TurningFrame* frame_of(Index body) const {
    return motion_.frames.empty() ? nullptr : &motion_.frames[at(body)];
  }
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  template <class T>
  static Index count_of(const std::vector<T>& list) {
    return static_cast<Index>(list.size());
  }
  bool is_sphere(Index v) const {
    return s_.vertex_radius[at(v)] > 0 &&
           std::none_of(s_.edges.begin(), s_.edges.end(),
                        [v](const auto& edge) { return edge[0] == v || edge[1] == v; });
  }
  bool bodies_may_touch(Index a, Index b) const {
    const CollisionBody &first = s_.bodies[at(a)], &second = s_.bodies[at(b)];
    if (!first.has_unknowns && !second.has_unknowns) return false;
    if (a == b) return first.touches_itself;
    const std::array<Index, 2> pair = {std::min(a, b), std::max(a, b)};
    return std::find(s_.forbidden.begin(), s_.forbidden.end(), pair) == s_.forbidden.end();
  }
  bool may_touch(Index v, Index w) const {
    return bodies_may_touch(s_.vertex_body[at(v)], s_.vertex_body[at(w)]);
  }
  static bool differ(std::initializer_list<Index> a, std::initializer_list<Index> b) {
    return std::find_first_of(a.begin(), a.end(), b.begin(), b.end()) == a.end();
  }
  MovingPoints points(std::initializer_list<Index> a,
                      std::initializer_list<Index> b,
                      double radius) const {
    MovingPoints made{};
    made.radius = radius;
    int k = 0;
    for (const auto* side : {&a, &b}) {
      for (const Index v : *side) {
        made.start[k] = motion_.start.vertices[at(v)].data();
        made.end[k++] = motion_.end.vertices[at(v)].data();
        double& sagitta = side == &a ? made.sagitta_a : made.sagitta_b;
        sagitta = std::max(sagitta, motion_.sagitta[at(v)]);
        (side == &a ? made.frame_a : made.frame_b) = frame_of(s_.vertex_body[at(v)]);
      }
    }
    return made;
  }

  const CollisionSurfaces& s_;
  const SurfaceMotion& motion_;
};

std::vector<TouchingPair> pairs_of(const CollideScene& scene,
                                   const CcdLimits& limits,
                                   double near) {
  std::vector<TouchingPair> pairs;
  AllPairs all(scene);
  all.for_each([&](PairKind kind, Index a, Index b, const MovingPoints& points) {
    const CcdResult result = all.ccd(kind, b, points, limits);
    if (result.time <= 1 || result.start_distance < near) {
      pairs.push_back({kind, a, b, result.time, result.start_distance});
    }
  });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}
}  // namespace

std::vector<TouchingPair> detected_by_force(const CollideScene& scene) {
  const double h = scene.surfaces.thickness;
  return pairs_of(scene, {h / 2, h / 10}, 2 * h);
}
std::vector<TouchingPair> checked_by_force(const CollideScene& scene) {
  const double h = scene.surfaces.thickness;
  return pairs_of(scene, {h / 10, h / 20}, -1);
}

ClosestPair closest_by_force(const CollideScene& scene, double cap) {
  CollideScene still = scene;
  still.motion = at_rest(scene.motion.start);
  const std::vector<TouchingPair> pairs = pairs_of(still, {1e-9, 1e-9}, cap);
  ClosestPair closest;
  closest.distance = cap;
  for (const TouchingPair& pair : pairs) {
    if (pair.start_distance >= closest.distance) continue;
    closest = {pair.kind, pair.a, pair.b, pair.start_distance};
  }
  return closest;
}

}  // namespace tetwarp::test

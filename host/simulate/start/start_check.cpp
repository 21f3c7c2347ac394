/// @file start_check.cpp
/// Lists the pairs of bodies in conflict, and reports the worst intersection.
#include "host/simulate/start/start_check.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "host/base/box_tree.hpp"
#include "host/base/disjoint_sets.hpp"
#include "host/base/parallel.hpp"
#include "host/scene/checks/scene_checks.hpp"
#include "host/scene/shapes/surface_lattice.hpp"
#include "host/simulate/start/inset_places.hpp"
#include "host/simulate/surfaces/near_pair.hpp"
#include "host/simulate/surfaces/round_shape.hpp"

namespace tetwarp {
namespace {

using Bodies = std::array<std::int32_t, 2>;

class StartSearch {
 public:
  StartSearch(const SceneSurfaces& scene, const SurfacePlaces& places)
      : surfaces_(scene.surfaces), inset_(scene.surfaces, places), places_(inset_.places()) {}

  std::vector<StartConflict> run(Detector& detector, int threads) {
    find_near(detector);
    find_crossings(threads);
    find_inside();
    std::vector<StartConflict> list;
    for (const auto& [bodies, conflict] : found_) list.push_back(conflict);
    return list;
  }

 private:
  void add(StartConflict conflict) {
    const auto [low, high] = std::minmax(conflict.bodies[0], conflict.bodies[1]);
    const Bodies key{low, high};
    if (conflict.kind != StartConflict::Kind::inside) conflict.bodies = key;
    const auto [entry, is_new] = found_.emplace(key, conflict);
    StartConflict& known = entry->second;
    if (is_new || known.kind < conflict.kind) return;
    if (known.kind == conflict.kind && known.distance <= conflict.distance) return;
    known = conflict;
  }

  void find_near(Detector& detector) {
    SurfaceMotion rest{places_, places_, std::vector<double>(places_.vertices.size(), 0.0)};
    detector.begin_step();
    for (const TouchingPair& pair : detector.detect(rest)) {
      const NearPair near = near_pair(pair, surfaces_, inset_.given());
      const auto [a, b] = near.bodies;
      const double rounding = inset_.rounding(a) + inset_.rounding(b);
      if (near.distance >= surfaces_.thickness - rounding) continue;
      Kind kind = Kind::near;
      if (is_of_meshes(pair)) {
        if (near_pair(pair, surfaces_, places_).distance <= least_apart(a, b)) kind = Kind::crosses;
      } else if (near.distance < -rounding) {
        kind = Kind::overlaps;
      }
      add({near.bodies, kind, near.place, near.distance});
    }
  }

  bool is_of_meshes(const TouchingPair& pair) const {
    if (pair.kind == PairKind::vertex_face) return at(surfaces_.vertex_radius, pair.a) == 0;
    return pair.kind == PairKind::edge_edge && at(surfaces_.edge_radius, pair.a) == 0 &&
           at(surfaces_.edge_radius, pair.b) == 0;
  }
  /// Inset surfaces that are not farther apart than this intersect, or it is not known on which
  /// side of each other they are: sheets that touch have none.
  double least_apart(std::int32_t a, std::int32_t b) const {
    constexpr double share = 0.1;  // of the way inwards
    const double own = inset_.is_inset(a) ? inset_.rounding(a) : 0;
    const double other = inset_.is_inset(b) ? inset_.rounding(b) : 0;
    const double way = std::max(own, other);
    return way > 0 ? share * way : inset_.rounding(a) + inset_.rounding(b);
  }

  bool may_meet(std::int32_t a, std::int32_t b) const {
    const CollisionBody &of_a = at(surfaces_.bodies, a), &of_b = at(surfaces_.bodies, b);
    if (a == b) return of_a.touches_itself;
    if (!of_a.has_unknowns && !of_b.has_unknowns) return false;
    const Bodies key{std::min(a, b), std::max(a, b)};
    return !std::binary_search(surfaces_.forbidden.begin(), surfaces_.forbidden.end(), key);
  }

  const Point3& place(std::int32_t vertex) const { return at(places_.vertices, vertex); }

  /// Finds edges that cross triangles, and keeps the first such pair of each two bodies.
  void find_crossings(int threads) {
    const BoxTree tree(boxes_of(places_.vertices, surfaces_.triangles));
    constexpr std::int64_t edges_per_task = 1024;
    const auto count = static_cast<std::int64_t>(surfaces_.edges.size());
    std::vector<std::vector<std::array<std::int32_t, 2>>> crossings(
        static_cast<std::size_t>((count + edges_per_task - 1) / edges_per_task));
    parallel_tasks(threads, static_cast<std::int64_t>(crossings.size()), [&](std::int64_t task) {
      auto& list = crossings[static_cast<std::size_t>(task)];
      const std::int64_t end = std::min(count, (task + 1) * edges_per_task);
      for (std::int64_t e = task * edges_per_task; e < end; ++e) {
        const auto edge = static_cast<std::int32_t>(e);
        visit_crossed(tree, edge, [&](std::int32_t triangle) { list.push_back({edge, triangle}); });
      }
    });
    for (const auto& list : crossings) {
      for (const auto& [edge, triangle] : list) {
        const auto& [from, to] = at(surfaces_.edges, edge);
        const std::int32_t other = at(surfaces_.triangles, triangle)[0];
        add({{at(surfaces_.vertex_body, from), at(surfaces_.vertex_body, other)},
             StartConflict::Kind::crosses,
             crossing_place(edge, triangle),
             0});
      }
    }
  }

  template <class Visit>
  void visit_crossed(const BoxTree& tree, std::int32_t edge, const Visit& visit) const {
    const auto& ends = at(surfaces_.edges, edge);
    const std::int32_t from = ends[0], to = ends[1];
    Bounds box;
    box.include(place(from));
    box.include(place(to));
    const std::int32_t body = at(surfaces_.vertex_body, from);
    tree.visit(box, [&](std::int32_t triangle) {
      const auto& [a, b, c] = at(surfaces_.triangles, triangle);
      if (!may_meet(body, at(surfaces_.vertex_body, a))) return;
      for (const std::int32_t corner : {a, b, c}) {
        if (corner == from || corner == to) return;
      }
      if (crosses(place(from), place(to), place(a), place(b), place(c))) visit(triangle);
    });
  }

  Point3 crossing_place(std::int32_t edge, std::int32_t triangle) const {
    const auto& [from, to] = at(surfaces_.edges, edge);
    const auto& [a, b, c] = at(surfaces_.triangles, triangle);
    const double start = tet_volume(place(from), place(a), place(b), place(c));
    const double end = tet_volume(place(to), place(a), place(b), place(c));
    return plus(place(from), times(start / (start - end), minus(place(to), place(from))));
  }

  /// A vertex of every connected part of a body. If no edge crosses a triangle, a part is
  /// completely inside or completely outside a closed surface.
  std::vector<std::int32_t> representatives(const CollisionBody& body) const {
    const auto count = static_cast<std::size_t>(body.vertex_end - body.first_vertex);
    DisjointSets parts(count);
    for (std::int32_t e = body.first_edge; e < body.edge_end; ++e) {
      const auto [a, b] = at(surfaces_.edges, e);
      parts.unite(static_cast<std::size_t>(a - body.first_vertex),
                  static_cast<std::size_t>(b - body.first_vertex));
    }
    std::vector<std::int32_t> list;
    for (std::size_t v = 0; v < count; ++v) {
      if (parts.root_of(v) == v) list.push_back(body.first_vertex + static_cast<std::int32_t>(v));
    }
    return list;
  }

  /// The triangles of a body if they form a closed surface.
  std::optional<Surface> closed_surface(std::int32_t index) const {
    if (!inset_.is_closed(index)) return std::nullopt;
    const CollisionBody& body = at(surfaces_.bodies, index);
    Surface surface;
    for (std::int32_t t = body.first_triangle; t < body.triangle_end; ++t) {
      std::array<std::int32_t, 3> own = at(surfaces_.triangles, t);
      for (std::int32_t& corner : own) corner -= body.first_vertex;
      surface.triangles.push_back(own);
    }
    surface.points.assign(places_.vertices.begin() + body.first_vertex,
                          places_.vertices.begin() + body.vertex_end);
    return surface;
  }

  void find_inside() {
    std::vector<std::pair<double, std::int32_t>> parts;  // first coordinate, vertex
    for (const CollisionBody& body : surfaces_.bodies) {
      for (const std::int32_t v : representatives(body)) parts.emplace_back(place(v)[0], v);
    }
    std::sort(parts.begin(), parts.end());
    for (std::int32_t b = 0; b < static_cast<std::int32_t>(surfaces_.bodies.size()); ++b) {
      const auto surface = closed_surface(b);
      if (!surface) continue;
      const Bounds box = bounds_of(surface->points);
      auto part = std::lower_bound(parts.begin(), parts.end(), std::pair(box.low[0], -1));
      for (; part != parts.end() && part->first <= box.high[0]; ++part) {
        const Point3& x = place(part->second);
        const std::int32_t a = at(surfaces_.vertex_body, part->second);
        const bool is_outside =
            x[1] < box.low[1] || x[1] > box.high[1] || x[2] < box.low[2] || x[2] > box.high[2];
        if (is_outside || a == b || !may_meet(a, b)) continue;
        // The center of a ball around a whole body may be inside that body.
        const bool is_round = at(surfaces_.vertex_radius, part->second) > 0;
        if (is_round && found_.contains({std::min(a, b), std::max(a, b)})) continue;
        if (winding_number(*surface, x) < 0.5) continue;
        add({{a, b}, StartConflict::Kind::inside, x, 0});
      }
    }
  }

  using Kind = StartConflict::Kind;

  const CollisionSurfaces& surfaces_;
  const InsetPlaces inset_;
  const SurfacePlaces& places_;  ///< of inset_
  std::map<Bodies, StartConflict> found_;
};

std::string point_text(const Point3& x) {
  std::string text;
  for (const double coordinate : x) text += (text.empty() ? "(" : ", ") + number_text(coordinate);
  return text + ")";
}

}  // namespace

std::vector<StartConflict> start_conflicts(const SceneSurfaces& scene,
                                           const SurfacePlaces& places,
                                           Detector& detector,
                                           int threads) {
  return StartSearch(scene, places).run(detector, threads);
}

bool check_start(const Scene& scene,
                 const SceneSurfaces& surfaces,
                 const SurfacePlaces& places,
                 Detector& detector,
                 int threads) {
  std::vector<StartConflict> conflicts = start_conflicts(surfaces, places, detector, threads);
  const bool are_near = !conflicts.empty();
  std::erase_if(conflicts, [](const StartConflict& of) { return !of.is_intersection(); });
  if (conflicts.empty()) return are_near;
  const StartConflict& worst = *std::min_element(
      conflicts.begin(), conflicts.end(), [](const StartConflict& a, const StartConflict& b) {
        return std::pair(a.kind, a.distance) < std::pair(b.kind, b.distance);
      });
  const auto [a, b] = worst.bodies;
  std::string what = place_of_body(scene, a);
  if (a == b) {
    what += " intersects itself";
  } else {
    what += worst.kind == StartConflict::Kind::inside ? " is inside " : " intersects ";
    what += place_of_body(scene, b);
  }
  what += " at the start, at " + point_text(worst.place);
  if (worst.kind == StartConflict::Kind::overlaps) {
    what += ", by " + number_text(-worst.distance) + " m";
  }
  if (conflicts.size() > 1) {
    what += " (" + std::to_string(conflicts.size()) + " pairs of bodies in all)";
  }
  const auto is_any = [&](BodyKind kind) {
    return std::ranges::any_of(worst.bodies, [&](std::int32_t body) {
      const auto index = static_cast<std::size_t>(body);
      return index < scene.bodies.size() && scene.bodies[index].kind == kind;
    });
  };
  if (a == b) {
    what += "; set its self to false or change its shape";
  } else {
    what += "; move them apart, ";
    if (is_any(BodyKind::fem)) what += "set cage_start of an elastic one, ";
    if (is_any(BodyKind::fem) || is_any(BodyKind::cloth)) what += "use the option untangle, ";
    what += "or set collide to false for the pair in contact.pairs";
  }
  throw std::invalid_argument(what);
}

}  // namespace tetwarp

/// @file start_check.cpp
/// Lists the pairs of bodies in conflict, and reports the worst.
#include "host/simulate/start/start_check.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "host/base/disjoint_sets.hpp"
#include "host/base/parallel.hpp"
#include "host/scene/checks/scene_checks.hpp"
#include "host/scene/surface_lattice.hpp"
#include "host/simulate/surfaces/near_pair.hpp"
#include "host/simulate/surfaces/round_shape.hpp"
#include "host/simulate/surfaces/triangle_tree.hpp"

namespace tetwarp {
namespace {

using Bodies = std::array<std::int32_t, 2>;

class StartSearch {
 public:
  StartSearch(const SceneSurfaces& scene, const SurfacePlaces& places)
      : surfaces_(scene.surfaces), places_(places) {}

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
      const NearPair near = near_pair(pair, surfaces_, places_);
      if (near.distance >= surfaces_.thickness) continue;
      add({near.bodies, StartConflict::Kind::near, near.place, near.distance});
    }
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
    const TriangleTree tree(places_.vertices, surfaces_.triangles);
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
  void visit_crossed(const TriangleTree& tree, std::int32_t edge, const Visit& visit) const {
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
  std::optional<Surface> closed_surface(const CollisionBody& body) const {
    if (body.first_triangle == body.triangle_end) return std::nullopt;
    std::vector<std::array<std::int32_t, 3>> half_edges;  // low, high, direction
    Surface surface;
    for (std::int32_t t = body.first_triangle; t < body.triangle_end; ++t) {
      std::array<std::int32_t, 3> own = at(surfaces_.triangles, t);
      for (std::int32_t& corner : own) corner -= body.first_vertex;
      surface.triangles.push_back(own);
      for (std::size_t c = 0; c < 3; ++c) {
        const std::int32_t from = own[c], to = own[(c + 1) % 3];
        half_edges.push_back({std::min(from, to), std::max(from, to), from < to ? 1 : -1});
      }
    }
    std::sort(half_edges.begin(), half_edges.end());
    for (std::size_t e = 0; e < half_edges.size();) {
      std::int32_t balance = 0;
      const std::size_t first = e;
      for (; e < half_edges.size() && half_edges[e][0] == half_edges[first][0] &&
             half_edges[e][1] == half_edges[first][1];
           ++e) {
        balance += half_edges[e][2];
      }
      if (balance != 0) return std::nullopt;
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
      const auto surface = closed_surface(at(surfaces_.bodies, b));
      if (!surface) continue;
      const Bounds box = bounds_of(surface->points);
      auto part = std::lower_bound(parts.begin(), parts.end(), std::pair(box.low[0], -1));
      for (; part != parts.end() && part->first <= box.high[0]; ++part) {
        const Point3& x = place(part->second);
        const std::int32_t a = at(surfaces_.vertex_body, part->second);
        const bool is_outside =
            x[1] < box.low[1] || x[1] > box.high[1] || x[2] < box.low[2] || x[2] > box.high[2];
        if (is_outside || a == b || !may_meet(a, b)) continue;
        // The centre of a ball around a whole body may be inside that body.
        const bool is_round = at(surfaces_.vertex_radius, part->second) > 0;
        if (is_round && found_.contains({std::min(a, b), std::max(a, b)})) continue;
        if (winding_number(*surface, x) < 0.5) continue;
        add({{a, b}, StartConflict::Kind::inside, x, 0});
      }
    }
  }

  const CollisionSurfaces& surfaces_;
  const SurfacePlaces& places_;
  std::map<Bodies, StartConflict> found_;
};

std::string point_text(const Point3& x) {
  return std::string("(") + number_text(x[0]) + ", " + number_text(x[1]) + ", " +
         number_text(x[2]) + ")";
}

}  // namespace

std::vector<StartConflict> start_conflicts(const SceneSurfaces& scene,
                                           const SurfacePlaces& places,
                                           Detector& detector,
                                           int threads) {
  return StartSearch(scene, places).run(detector, threads);
}

void check_start(const Scene& scene,
                 const SceneSurfaces& surfaces,
                 const SurfacePlaces& places,
                 Detector& detector,
                 int threads) {
  const std::vector<StartConflict> conflicts = start_conflicts(surfaces, places, detector, threads);
  if (conflicts.empty()) return;
  const StartConflict& worst = *std::min_element(
      conflicts.begin(), conflicts.end(), [](const StartConflict& a, const StartConflict& b) {
        return std::pair(a.kind, a.distance) < std::pair(b.kind, b.distance);
      });
  const auto [a, b] = worst.bodies;
  std::string what = place_of_body(scene, a);
  if (a == b) {
    what += worst.kind == StartConflict::Kind::near ? " is nearer to itself than the thickness"
                                                    : " intersects itself";
  } else if (worst.kind == StartConflict::Kind::near) {
    what += " and " + place_of_body(scene, b) + " are nearer than the thickness";
  } else {
    what += worst.kind == StartConflict::Kind::inside ? " is inside " : " intersects ";
    what += place_of_body(scene, b);
  }
  what += " at the start, at " + point_text(worst.place);
  if (worst.kind == StartConflict::Kind::near) {
    what += ": their distance is " + number_text(worst.distance) + " m, the thickness " +
            number_text(surfaces.surfaces.thickness) + " m";
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
    what += "; set its self to false, make the thickness smaller or change its shape";
  } else {
    what += "; move them apart, ";
    if (is_any(BodyKind::fem)) what += "set cage_start of an elastic one, ";
    if (is_any(BodyKind::fem) || is_any(BodyKind::cloth)) what += "use the option untangle, ";
    what += "or set collide to false for the pair in contact.pairs";
  }
  throw std::invalid_argument(what);
}

}  // namespace tetwarp

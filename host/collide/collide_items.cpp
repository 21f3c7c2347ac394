/// @file collide_items.cpp
/// Makes items and runs of vertices, and checks the surfaces.
#include "host/collide/collide_items.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace tetwarp {
namespace {
constexpr std::int32_t run_length = 32;  // vertices or boxes of a run

[[noreturn]] void fail(const std::string& problem) {
  throw std::invalid_argument("collision surfaces: " + problem);
}

void check_range(const char* what, std::int32_t first, std::int32_t past, std::size_t count) {
  if (first < 0 || past < first || static_cast<std::size_t>(past) > count) {
    fail("a body's " + std::string(what) + " " + std::to_string(first) + " to " +
         std::to_string(past) + " are not among " + std::to_string(count));
  }
}

void check_sizes(const CollisionSurfaces& s) {
  const std::size_t vertices = s.vertex_body.size();
  const bool has_flat = !s.edge_is_flat.empty() || !s.vertex_is_flat.empty();
  if (s.vertex_radius.size() != vertices || s.vertex_area.size() != vertices ||
      s.edge_radius.size() != s.edges.size() ||
      (has_flat &&
       (s.edge_is_flat.size() != s.edges.size() || s.vertex_is_flat.size() != vertices))) {
    fail("lists of vertices or edges have different lengths");
  }
  if (!(s.thickness > 0)) fail("thickness must be positive");
  if (s.triangles.size() + s.edges.size() + vertices >
      static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    fail("more than 2^31 - 1 features");
  }
  for (const CollisionBody& body : s.bodies) {
    check_range("vertices", body.first_vertex, body.vertex_end, vertices);
    check_range("edges", body.first_edge, body.edge_end, s.edges.size());
    check_range("triangles", body.first_triangle, body.triangle_end, s.triangles.size());
    check_range("planes", body.first_plane, body.plane_end, s.plane_body.size());
  }
}

/// Edges of one body by their vertices.
class EdgeFinder {
 public:
  EdgeFinder(const CollisionSurfaces& s, const CollisionBody& body) {
    for (std::int32_t e = body.first_edge; e < body.edge_end; ++e) {
      const auto& edge = s.edges[static_cast<std::size_t>(e)];
      edges_.push_back({key_of(edge[0], edge[1]), e});
    }
    std::sort(edges_.begin(), edges_.end());
  }
  std::int32_t find(std::int32_t v, std::int32_t w) const {
    const auto at = std::lower_bound(edges_.begin(), edges_.end(), std::pair{key_of(v, w), 0});
    if (at == edges_.end() || at->first != key_of(v, w)) {
      fail("the edge of vertices " + std::to_string(v) + " and " + std::to_string(w) +
           " of a triangle is missing");
    }
    return at->second;
  }

 private:
  using Key = std::array<std::int32_t, 2>;
  static Key key_of(std::int32_t v, std::int32_t w) { return {std::min(v, w), std::max(v, w)}; }

  std::vector<std::pair<Key, std::int32_t>> edges_;
};

class ItemMaker {
 public:
  ItemMaker(const CollisionSurfaces& surfaces, bool skips_flat_edges, CollideItems& made)
      : s_(surfaces), made_(made) {
    if (skips_flat_edges) {  // as if an item owned them
      vertex_is_owned_ = s_.vertex_is_flat;
      edge_is_owned_ = s_.edge_is_flat;
    }
    made_.flat_edges = std::count(edge_is_owned_.begin(), edge_is_owned_.end(), 1);
    vertex_is_owned_.resize(s_.vertex_body.size());
    edge_is_owned_.resize(s_.edges.size());
  }

  void add_body(std::int32_t b) {
    const CollisionBody& body = s_.bodies[static_cast<std::size_t>(b)];
    const EdgeFinder edges(s_, body);
    for (std::int32_t t = body.first_triangle; t < body.triangle_end; ++t) {
      const auto& corner = s_.triangles[static_cast<std::size_t>(t)];
      CollideItem item = start(b, 3, corner.data());
      item.face = t;
      for (std::size_t k = 0; k < 3; ++k) {
        item.owned_edge[k] = own_edge(edges.find(corner[k], corner[(k + 1) % 3]));
      }
      made_.items.push_back(item);
    }
    for (std::int32_t e = body.first_edge; e < body.edge_end; ++e) {
      if (!(s_.edge_radius[static_cast<std::size_t>(e)] > 0)) continue;
      CollideItem item = start(b, 2, s_.edges[static_cast<std::size_t>(e)].data());
      item.owned_edge[0] = own_edge(e);
      made_.items.push_back(item);
    }
    for (std::int32_t v = body.first_vertex; v < body.vertex_end; ++v) {
      if (vertex_is_owned_[static_cast<std::size_t>(v)] == 0) {
        made_.items.push_back(start(b, 1, &v));
      }
    }
  }

 private:
  CollideItem start(std::int32_t body, std::int32_t count, const std::int32_t* vertex) {
    CollideItem item{{-1, -1, -1}, {-1, -1, -1}, -1, body, count, 0};
    const CollisionBody& own = s_.bodies[static_cast<std::size_t>(body)];
    for (std::int32_t k = 0; k < count; ++k) {
      const std::int32_t v = vertex[k];
      if (v < own.first_vertex || v >= own.vertex_end) {
        fail("vertex " + std::to_string(v) + " of body " + std::to_string(body) +
             " is not among its own");
      }
      item.vertex[k] = v;
      auto& is_owned = vertex_is_owned_[static_cast<std::size_t>(v)];
      if (is_owned == 0) item.owns_vertex |= 1 << k;
      is_owned = 1;
    }
    return item;
  }
  /// @returns the edge, or -1 if another item owns it or none does
  std::int32_t own_edge(std::int32_t edge) {
    auto& is_owned = edge_is_owned_[static_cast<std::size_t>(edge)];
    return std::exchange(is_owned, std::uint8_t{1}) != 0 ? -1 : edge;
  }

  const CollisionSurfaces& s_;
  CollideItems& made_;
  std::vector<std::uint8_t> vertex_is_owned_, edge_is_owned_;
};

void add_runs(const CollisionBody& body, std::int32_t b, std::vector<VertexRun>& runs) {
  for (std::int32_t v = body.first_vertex; v < body.vertex_end; v += run_length) {
    runs.push_back({v, std::min(v + run_length, body.vertex_end), b});
  }
}

/// Adds runs of the last runs of `made`, each of one body.
void add_level(CollideItems& made) {
  const auto end = static_cast<std::int32_t>(made.runs.size());
  for (auto first = static_cast<std::int32_t>(made.levels.back()); first < end;) {
    const std::int32_t body = made.runs[static_cast<std::size_t>(first)].body;
    std::int32_t past = first + 1;
    while (past < end && past < first + run_length &&
           made.runs[static_cast<std::size_t>(past)].body == body) {
      ++past;
    }
    made.runs.push_back({first, past, body});
    first = past;
  }
  made.levels.push_back(end);
}

/// Whether a body has two runs from `first` on.
bool has_twins(const std::vector<VertexRun>& runs, std::int64_t first) {
  return std::adjacent_find(
             runs.begin() + first, runs.end(),
             [](const VertexRun& a, const VertexRun& b) { return a.body == b.body; }) != runs.end();
}
}  // namespace

CollideView CollideItems::view_of_bodies() const {
  CollideView view{};
  view.bodies = {bodies.data(), std::ssize(bodies)};
  view.forbidden = {forbidden.data(), std::ssize(forbidden)};
  return view;
}

CollideItems make_collide_items(const CollisionSurfaces& surfaces, bool skips_flat_edges) {
  check_sizes(surfaces);
  CollideItems made;
  made.items.reserve(surfaces.triangles.size());
  ItemMaker maker(surfaces, skips_flat_edges, made);
  auto next = surfaces.forbidden.begin();
  for (std::size_t b = 0; b < surfaces.bodies.size(); ++b) {
    const CollisionBody& body = surfaces.bodies[b];
    const auto number = static_cast<std::int32_t>(b);
    maker.add_body(number);
    add_runs(body, number, made.runs);
    CollideBody own{};
    own.item_end = static_cast<std::int32_t>(made.items.size());
    own.has_unknowns = body.has_unknowns;
    own.touches_itself = body.touches_itself;
    own.is_rigid = body.is_rigid;
    own.forbidden_begin = static_cast<std::int32_t>(made.forbidden.size());
    for (; next != surfaces.forbidden.end() && (*next)[0] == number; ++next) {
      made.forbidden.push_back((*next)[1]);
    }
    own.forbidden_end = static_cast<std::int32_t>(made.forbidden.size());
    made.bodies.push_back(own);
  }
  if (next != surfaces.forbidden.end()) fail("forbidden pairs are not sorted");
  made.levels.push_back(0);
  while (has_twins(made.runs, made.levels.back())) add_level(made);
  made.levels.push_back(static_cast<std::int64_t>(made.runs.size()));
  return made;
}

}  // namespace tetwarp

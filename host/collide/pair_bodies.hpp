/// @file pair_bodies.hpp
/// The bodies or obstacles of the features of a pair.
#pragma once
#include <array>
#include <cstdint>

#include "host/base/point3.hpp"
#include "host/collide/collision_surfaces.hpp"
#include "kernels/collide/pair_kind.hpp"

namespace tetwarp {

/// @tparam Pair  with kind and features, as TouchingPair or FeaturePair
template <class Pair>
std::array<std::int32_t, 2> bodies_of(const Pair& pair, const CollisionSurfaces& surfaces) {
  const auto of_vertex = [&](std::int32_t v) { return at(surfaces.vertex_body, v); };
  const auto of_edge = [&](std::int32_t e) { return of_vertex(at(surfaces.edges, e)[0]); };
  switch (pair.kind) {
    case PairKind::vertex_face:
      return {of_vertex(pair.a), of_vertex(at(surfaces.triangles, pair.b)[0])};
    case PairKind::edge_edge:
      return {of_edge(pair.a), of_edge(pair.b)};
    case PairKind::vertex_edge:
      return {of_vertex(pair.a), of_edge(pair.b)};
    case PairKind::vertex_vertex:
      return {of_vertex(pair.a), of_vertex(pair.b)};
    case PairKind::vertex_plane:
      break;
  }
  return {of_vertex(pair.a), at(surfaces.plane_body, pair.b)};
}

}  // namespace tetwarp

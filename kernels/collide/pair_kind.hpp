/// @file pair_kind.hpp
/// Pairs of features of surfaces.
#pragma once
#include <cstdint>

namespace tetwarp {

/// First feature a, second feature b: numbers in the lists of CollisionSurfaces.
enum class PairKind : std::uint8_t {
  vertex_face,    ///< a vertex with or without a radius
  edge_edge,      ///< a < b
  vertex_edge,    ///< a vertex with a radius, an edge with a radius
  vertex_vertex,  ///< both with a radius, a < b
  vertex_plane
};

struct FeaturePair {
  PairKind kind;
  std::int32_t a, b;
};

}  // namespace tetwarp

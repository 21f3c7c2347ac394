/// @file start_shrink.hpp
/// Bodies that overlap at the start are scaled about a point inside them until they are apart.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/collide/detector.hpp"
#include "host/simulate/surfaces/scene_surfaces.hpp"

namespace tetwarp {

/// A body whose nodes are at center + scale (x - center), where x are their positions at full size.
struct ShrunkBody {
  std::int32_t body = 0;
  Point3 center{0, 0, 0};
  double scale = 1;
};

/// Input of the preparation of a start; members are kept by the caller.
struct StartParts {
  const Scene& scene;
  const SceneGeometry& geometry;
  const SceneSurfaces& surfaces;
  Detector& detector;
  int threads = 1;
};

/// Scales elastic bodies and cloth that intersect others about their medial nodes, by successive
/// factors of 0.9 for all bodies in conflict, until no pair with one of them is nearer than the
/// thickness. Pairs of two bodies that must not shrink are ignored.
/// @param may_shrink  [bodies]
/// @param what        why the bodies shrink, for messages
/// @param model       in, out: its start
/// @returns the bodies that were scaled, by number
/// @throws std::invalid_argument  in one line naming two bodies that are still in conflict at 1/30
///         of their size, or a body that intersects itself
std::vector<ShrunkBody> shrink_apart(const StartParts& parts,
                                     const std::vector<std::uint8_t>& may_shrink,
                                     const std::string& what,
                                     Model& model);

}  // namespace tetwarp

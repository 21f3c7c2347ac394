/// @file turning_moments.cpp
/// Tells balls that nothing holds from other rigid bodies.
#include "host/simulate/run/turning_moments.hpp"

#include <algorithm>

#include "host/base/index_of.hpp"

namespace tetwarp {
namespace {

bool are_equal(const Point3& moments) {
  constexpr double rounding = 1e-12;  // of integrals over the triangles of a ball
  const auto [least, most] = std::ranges::minmax(moments);
  return most - least <= rounding * most;
}

/// Whether all that touches is the center, with a radius.
bool touches_as_ball(const CollisionBody& parts) {
  return parts.first_triangle == parts.triangle_end && parts.vertex_end - parts.first_vertex <= 1;
}

}  // namespace

std::vector<Point3> turning_moments(const SimulatedScene& scene) {
  const ModelRigid& rigid = scene.model.rigid;
  std::vector<std::uint8_t> is_held(rigid.inertia.size(), 0);
  for (const auto* ends : {&scene.model.springs.a, &scene.model.springs.b}) {
    for (const ModelPoint& end : *ends) {
      if (end.rigid >= 0) is_held[index_of(end.rigid)] = 1;
    }
  }
  std::vector<Point3> moments = rigid.inertia;
  for (std::size_t r = 0; r < moments.size(); ++r) {
    const CollisionBody& parts = scene.surfaces.surfaces.bodies[index_of(rigid.body[r])];
    if (is_held[r] == 0 && are_equal(moments[r]) && touches_as_ball(parts)) moments[r] = {0, 0, 0};
  }
  return moments;
}

}  // namespace tetwarp

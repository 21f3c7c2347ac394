/// @file near_planes.cpp
/// A bound of the distance between a moving plane and a box.
#include "host/collide/near_planes.hpp"

#include <algorithm>
#include <cmath>

namespace tetwarp {
namespace {
/// Whether a plane turns with a frame. Such a plane is taken as near all bodies: the bound of
/// is_near() is for planes that turn about their own points.
bool turns_with_frame(const SurfaceMotion& motion, std::int32_t body) {
  if (motion.frames.empty()) return false;
  const double* const turn = motion.frames[static_cast<std::size_t>(body)].turn;
  return turn[0] != 0 || turn[1] != 0 || turn[2] != 0;
}

/// Whether a plane may come within `distance` of a box: the least height of a corner above it.
bool is_near(const Box& box, const PlanePlace& start, const PlanePlace& end, double distance) {
  double size = 0;
  for (int k = 0; k < 3; ++k) size = std::max({size, std::abs(box.low[k]), std::abs(box.high[k])});
  for (const PlanePlace* normal : {&start, &end}) {
    for (const PlanePlace* place : {&start, &end}) {
      double height = 0, far = size;
      for (std::size_t k = 0; k < 3; ++k) {
        const double n = normal->normal[k];
        height += n * ((n > 0 ? box.low[k] : box.high[k]) - place->point[k]);
        far = std::max(far, std::abs(place->point[k]));
      }
      if (height - 0x1p-46 * far <= distance) return true;
    }
  }
  return false;
}
}  // namespace

void NearPlanes::find(const CollisionSurfaces& surfaces,
                      const CollideItems& items,
                      const BodyPartners& boxes,
                      const SurfaceMotion& motion,
                      double distance,
                      std::span<const std::uint8_t> is_still) {
  const CollideView scene = items.view_of_bodies();
  start.assign(items.bodies.size() + 1, 0);
  planes.clear();
  for (std::size_t b = 0; b < items.bodies.size(); ++b) {
    for (std::size_t p = 0; p < surfaces.plane_body.size() && boxes.has_box[b] != 0; ++p) {
      const auto own = static_cast<std::int32_t>(b);
      const std::int32_t other = surfaces.plane_body[p];
      if (!is_still.empty() && is_still[b] != 0 && is_still[static_cast<std::size_t>(other)] != 0) {
        continue;
      }
      if (own == other || !scene.may_touch(std::min(own, other), std::max(own, other))) continue;
      if (turns_with_frame(motion, other) ||
          is_near(boxes.boxes[b], motion.start.planes[p], motion.end.planes[p], distance)) {
        planes.push_back(static_cast<std::int32_t>(p));
      }
    }
    start[b + 1] = static_cast<std::int32_t>(planes.size());
  }
}

}  // namespace tetwarp

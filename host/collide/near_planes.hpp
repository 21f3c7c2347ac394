/// @file near_planes.hpp
/// Which planes bodies can reach during a motion.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "host/collide/body_partners.hpp"
#include "host/collide/collide_items.hpp"
#include "host/collide/collision_surfaces.hpp"

namespace tetwarp {

/// Lists by body; memory is kept.
struct NearPlanes {
  std::vector<std::int32_t> start;   ///< [bodies + 1] into `planes`
  std::vector<std::int32_t> planes;  ///< those near each body; empty: none is near any body

  /// Finds the planes that may lie within a distance of a body's box at any time of the motion.
  /// @param boxes     those of bodies are read
  /// @param distance  [m]
  /// @param is_still  [bodies] planes of bodies that do not move are not near others that do not
  ///                  move; or empty
  void find(const CollisionSurfaces& surfaces,
            const CollideItems& items,
            const BodyPartners& boxes,
            const SurfaceMotion& motion,
            double distance,
            std::span<const std::uint8_t> is_still);
};

}  // namespace tetwarp

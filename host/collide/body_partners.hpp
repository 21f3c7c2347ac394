/// @file body_partners.hpp
/// Which bodies can meet during a motion: those whose boxes overlap, and planes that bodies reach.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "host/collide/collide_items.hpp"
#include "host/collide/collision_surfaces.hpp"

namespace tetwarp {

/// Lists by body; memory is kept.
struct BodyPartners {
  std::vector<Box> boxes;  ///< [bodies + 1]; the last one holds all bodies with a partner
  std::vector<std::uint8_t> has_box;      ///< [bodies] has vertices
  std::vector<std::int32_t> start;        ///< [bodies + 1]
  std::vector<std::int32_t> bodies;       ///< indices into `boxes`
  std::vector<std::int32_t> plane_start;  ///< [bodies + 1]
  std::vector<std::int32_t> planes;
  bool has_pairs = false;   ///< some body has a partner
  bool has_planes = false;  ///< some body is near a plane

  /// Sets `boxes` and `has_box` to the boxes of the last runs.
  void set_boxes(const CollideItems& items, const View<const RunBox>& of_bodies);
  /// Finds the partners of all bodies. Of very many bodies each that overlaps the space of the
  /// others counts as a partner.
  /// @param is_still  [bodies] those that do not move are no partners of each other; or empty
  void find_bodies(const CollideItems& items, std::span<const std::uint8_t> is_still);
  /// Finds the planes that lie within `distance` of a body's box at any time.
  void find_planes(const CollisionSurfaces& surfaces,
                   const CollideItems& items,
                   const SurfaceMotion& motion,
                   double distance,
                   std::span<const std::uint8_t> is_still);

 private:
  void find_crowd(std::int32_t count, std::span<const std::uint8_t> is_still);

  std::vector<std::int32_t> order_;
  std::vector<std::array<std::int32_t, 2>> pairs_;
};

}  // namespace tetwarp

/// @file body_partners.hpp
/// Which bodies can meet during a motion: those whose boxes overlap.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "host/collide/collide_items.hpp"

namespace tetwarp {

/// Lists by body; memory is kept.
struct BodyPartners {
  std::vector<Box> boxes;  ///< [bodies + 1]; the last one holds all bodies with a partner
  std::vector<std::uint8_t> has_box;  ///< [bodies] has vertices
  std::vector<std::int32_t> start;    ///< [bodies + 1] into `bodies`
  std::vector<std::int32_t> bodies;   ///< partners of each body, as indices into `boxes`
  bool has_pairs = false;             ///< some body has a partner

  /// Sets `boxes` and `has_box` to the boxes of the last runs.
  void set_boxes(const CollideItems& items, const View<const RunBox>& of_bodies);
  /// Finds the partners of all bodies. For more than 512 bodies, pairs of bodies are not compared:
  /// the box of all bodies is the one partner of each body that can meet another one.
  /// @param scene     bodies and forbidden pairs, on the host
  /// @param is_still  [bodies] two bodies that do not move are not partners; or empty
  void find(const CollideView& scene, std::span<const std::uint8_t> is_still);

 private:
  void find_overlapping(const CollideView& scene, std::span<const std::uint8_t> is_still);
  void find_crowd(std::span<const std::uint8_t> is_still);
  void make_lists();

  std::vector<std::int32_t> order_;                 ///< bodies with a box
  std::vector<std::array<std::int32_t, 2>> pairs_;  ///< body, partner
};

}  // namespace tetwarp

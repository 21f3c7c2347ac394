/// @file contact_islands.hpp
/// The coupling islands that have contacts, and how contacts join them to contact islands.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "host/simulate/surfaces/scene_surfaces.hpp"
#include "kernels/body/contact_arms.hpp"

namespace tetwarp {

class ContactIslands {
 public:
  ContactIslands(const SceneSurfaces& scene, const Model& model);

  /// Joins the coupling islands on both sides of each contact.
  void join(std::span<const ContactSides> contacts);

  std::int32_t count() const { return static_cast<std::int32_t>(root_.size()); }
  /// Coupling island of a block with unknowns, or -1.
  std::int32_t of_block(std::int32_t block) const {
    return island_of_[static_cast<std::size_t>(block)];
  }
  /// The lowest coupling island of its contact island.
  std::int32_t root(std::int32_t island) const { return root_[static_cast<std::size_t>(island)]; }
  bool has_contacts(std::int32_t island) const {
    return has_contacts_[static_cast<std::size_t>(island)] != 0;
  }
  /// Whether A couples blocks of the island: false for a single rigid body.
  bool is_coupled(std::int32_t island) const {
    return is_coupled_[static_cast<std::size_t>(island)] != 0;
  }
  /// Whether A couples blocks of any coupling island of its contact island.
  bool is_soft(std::int32_t island) const {
    return is_soft_[static_cast<std::size_t>(root_[static_cast<std::size_t>(island)])] != 0;
  }
  /// For each contact one of its coupling islands; -1: it acts on prescribed blocks only. Blocks
  /// with a weight below 1e-12 in a point, which is rounding of zero, do not count. One side with
  /// unknowns is enough, however small its weights are against those of the other side.
  const std::vector<std::int32_t>& of_contact() const { return of_contact_; }
  /// Coupling islands with contacts, joined by contacts.
  std::int64_t contact_island_count() const { return contact_island_count_; }

 private:
  /// The blocks with unknowns that move a vertex or a side of a contact; all of one body.
  struct Unknowns {
    std::int32_t island = -1;  ///< their coupling island, -1: there are none
    double share = 0;          ///< the largest weight
  };
  Unknowns of_side(const ContactSide& side) const;

  std::int32_t first_frame_;                ///< first block of frames
  std::vector<std::int32_t> island_of_;     ///< [block_count]
  std::vector<Unknowns> of_vertex_;         ///< [vertices]
  std::vector<std::uint8_t> is_coupled_;    ///< [islands] more than a single rigid body
  std::vector<std::uint8_t> has_contacts_;  ///< [islands]
  std::vector<std::uint8_t> is_soft_;       ///< [islands] set at the roots
  std::vector<std::int32_t> root_;          ///< [islands] lowest island of the contact island
  std::vector<std::int32_t> of_contact_;
  std::int64_t contact_island_count_ = 0;
};

}  // namespace tetwarp

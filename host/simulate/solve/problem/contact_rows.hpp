/// @file contact_rows.hpp
/// The Jacobian of contacts by blocks of a Model: u = J v along the axes of each contact.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "host/simulate/surfaces/scene_surfaces.hpp"
#include "kernels/body/contact_arms.hpp"

namespace tetwarp {

/// For each contact the blocks that it acts on, ascending, each once.
struct ContactRows {
  std::vector<std::int32_t> start;           ///< [contacts + 1]
  std::vector<std::int32_t> block;           ///< [entries] of the model
  std::vector<std::array<double, 9>> value;  ///< [entries] row k: velocity along axis k of the
                                             ///< contact per velocity of the block

  // The input of the numbers; see ContactRowsOp.
  std::vector<double> axes;             ///< [contacts][9]
  std::vector<std::int32_t> arm_start;  ///< [contacts + 1]
  std::vector<ContactArm> arms;         ///< of nodes and frames, in the order of the blocks
  std::vector<ArmPlace> places;         ///< [arms] in `value`

  std::vector<std::vector<BlockArm>> parts;  ///< work of set_contact_rows(); kept as memory

  std::span<const std::int32_t> blocks_of(std::size_t contact) const {
    return std::span(block).subspan(static_cast<std::size_t>(start[contact]),
                                    static_cast<std::size_t>(start[contact + 1] - start[contact]));
  }
  /// The block of an arm: its node, or the first block of its frame. Both blocks of a frame have
  /// unknowns, or neither has.
  std::int32_t block_of_arm(std::int32_t arm) const {
    return block[static_cast<std::size_t>(places[static_cast<std::size_t>(arm)].first / 9)];
  }
};

/// @param state    at the start of the step
/// @param sides    [contacts]
/// @param takes    [contacts] 1: the contact gets rows; empty: all do
/// @param threads  any number: same rows
/// @param rows     out; memory is kept
void set_contact_rows(const SceneSurfaces& scene,
                      const Model& model,
                      const ModelState& state,
                      std::span<const ContactSides> sides,
                      std::span<const std::uint8_t> takes,
                      int threads,
                      ContactRows& rows);

}  // namespace tetwarp

/// @file pressing_impulses.hpp
/// PressingImpulses: what presses on the areas of contacts.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <tetwarp/contact_tracker.hpp>

#include "host/simulate/surfaces/scene_surfaces.hpp"

namespace tetwarp {

/// Spreads the normal impulses of contacts over their areas; keeps its memory.
///
/// Many distributions of impulses have the same effect on the bodies: which of them a solve finds
/// is a matter of its tolerance, and contacts without area carry a part of any size. Bonds form by
/// a pressure that all of them have in common. Between two rigid bodies it is linear over each
/// patch (see RigidPatches) and has the force and moment of the patch's contacts. Else it is, at
/// each node of a deformable body, the force on the node over its part of the area, interpolated
/// between nodes as the surface is; of two deformable bodies the mean of both. The sum stays, but
/// for forces on nodes without area. Contacts that are open by more than a tenth of the thickness
/// at the start of the step take no part.
class PressingImpulses {
 public:
  /// @param surfaces  kept by the caller
  explicit PressingImpulses(const SceneSurfaces& surfaces);

  /// @param contacts  of the step, sorted by key
  /// @param records   of these contacts
  /// @param impulses  of these contacts, [contact_count][3] along their axes [N s]
  /// @returns [contact_count] [N s], until the next call; empty: no pressure forms bonds
  std::span<const double> spread(std::span<const TrackedContact> contacts,
                                 std::span<const ContactRecord> records,
                                 std::span<const double> impulses);

 private:
  /// What is constant within a call.
  struct Step {
    std::span<const TrackedContact> contacts;
    std::span<const ContactRecord> records;
    std::span<const double> impulses;
    double open;  ///< gap beyond which contacts do not touch [m]

    double impulse(std::size_t c) const { return impulses[3 * c]; }
    bool touches(std::size_t c) const { return contacts[c].gap[0] <= open; }
  };
  /// A node that a contact moves with.
  struct Entry {
    std::size_t contact;
    std::int32_t node;
    double weight;
  };
  struct NodeSum {
    double impulse = 0, area = 0;
  };

  bool forms_bonds(const ContactRecord& record) const;
  void spread_pair(const Step& step, std::span<const std::size_t> pair);
  void spread_patches(const Step& step, std::span<const std::size_t> pair);
  void spread_over_nodes(const Step& step,
                         std::span<const std::size_t> pair,
                         bool of_a,
                         double share);
  NodeSum& sum_of(std::int32_t node);
  void list_nodes(const TrackedContact& of, bool of_a, std::size_t contact);

  const SceneSurfaces& surfaces_;
  bool has_bonding_ = false;
  std::vector<double> pressing_;
  std::vector<std::size_t> order_, points_;  ///< contacts
  std::vector<Entry> entries_;               ///< of one side of a pair
  std::vector<NodeSum> sums_;                ///< [nodes of the model], zero between calls
};

}  // namespace tetwarp

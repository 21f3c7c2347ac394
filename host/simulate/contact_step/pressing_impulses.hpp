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
/// a pressure that all of them have in common, on areas that face one way. Between two rigid bodies
/// it is linear over each patch (see RigidPatches) and has the force and moment of the patch's
/// contacts; where that would pull at a point, the others have the force. Else it is, at each node
/// of a deformable body, the force on the node over its part of the area, interpolated between
/// nodes as the surface is; of two deformable bodies the mean of both. Forces on nodes without area
/// are left out. A contact that is open by more than a tenth of the thickness at the start of the
/// step, and closes within it, keeps its own impulse; in a patch, if it is more open than all that
/// push, it has none.
class PressingImpulses {
 public:
  /// @param surfaces   kept by the caller
  /// @param materials  of the tracker
  PressingImpulses(const SceneSurfaces& surfaces, std::span<const ContactMaterial> materials);

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
    double open;  ///< gap beyond which contacts do not touch at the start of the step [m]

    double impulse(std::size_t c) const { return impulses[3 * c]; }
    double gap(std::size_t c) const { return contacts[c].gap[0]; }
  };
  struct Area {
    Point3 normal;      ///< of its first contact
    std::int32_t slot;  ///< of a patch
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

  void spread_pair(const Step& step, std::span<const std::size_t> pair);
  void divide(const Step& step, std::span<const std::size_t> pair, bool has_patches);
  void spread_patch(const Step& step);
  void spread_over_nodes(const Step& step, bool of_a, bool of_b, double share);
  void list_nodes(std::size_t contact, const MaterialPoint& point, std::int32_t body);
  NodeSum& sum_of(std::int32_t node);

  const SceneSurfaces& surfaces_;
  std::vector<bool> forms_bonds_;  ///< [materials]
  std::vector<double> pressing_;
  std::vector<std::size_t> order_, group_, points_;           ///< contacts; group_: of one area
  std::vector<Area> areas_;                                   ///< of one pair
  std::vector<std::pair<std::size_t, std::size_t>> members_;  ///< areas and their contacts
  std::vector<Entry> entries_;                                ///< of one group
  std::vector<NodeSum> sums_;  ///< [nodes of the model], zero between calls
};

}  // namespace tetwarp

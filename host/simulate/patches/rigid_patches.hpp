/// @file rigid_patches.hpp
/// Replaces the many contacts of two rigid bodies that touch with faces by few.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include <tetwarp/contact_tracker.hpp>

#include "host/simulate/patches/patch_moments.hpp"
#include "host/simulate/patches/patch_supports.hpp"
#include "host/simulate/surfaces/scene_surfaces.hpp"

namespace tetwarp {

/// Reduces the contacts of each pair of rigid bodies, or of a rigid body and an obstacle; keeps its
/// memory.
///
/// Contacts whose normals differ by less than 20 degrees form a patch. Its contacts become supports
/// without area, see PatchSupports. If the bodies adhere, four adhesion points c +- sqrt(2 l_k) e_k
/// have a quarter of the area each: they have the same area, centroid c and second moments l_k
/// (with axes e_k) as the patch, and the same force and moment for gaps on a plane. Triangles that
/// touch with all three corners count with the second moments of their area, others with those of
/// their corners.
///
/// A bonded point is not reported again, and the tracker keeps it in place, until the patch has
/// grown by more than a tenth. Then the point moves, and its beta becomes the mean over the larger
/// area. The records hold everything that this needs.
class RigidPatches {
 public:
  /// Features of adhesion points: those of the first patch of two bodies are first_feature to
  /// first_feature - 3, those of the second the next four, and so on; the feature of body b is
  /// always first_feature.
  static constexpr std::int32_t first_feature = -1000;
  /// Whether a contact is an adhesion point.
  static bool is_point(const ContactKey& key) { return key.feature_b == first_feature; }
  /// The number of the patch of an adhesion point among those of its bodies.
  static std::int32_t slot_of(const ContactKey& key) { return (first_feature - key.feature_a) / 4; }

  /// @param scene, areas  kept by the caller
  RigidPatches(const SceneSurfaces& scene, const TouchAreas& areas)
      : scene_(scene), moments_(areas, scene.surfaces) {}

  /// @param contacts  sorted by key, with sides in the order of keys
  /// @param vertices  at the start of the step
  /// @param records   at the start of the step, sorted by key
  void reduce(std::vector<ReportedContact>& contacts,
              const std::vector<Point3>& vertices,
              std::span<const ContactRecord> records);

 private:
  bool is_rigid(const ReportedContact& contact) const;
  void reduce_pair(std::vector<ReportedContact>& contacts,
                   const std::vector<Point3>& vertices,
                   std::span<const ContactRecord> records);
  void add_points(const ReportedContact& first,
                  const PatchPoints& points,
                  std::span<const ContactRecord> records);
  std::int32_t slot_of(const ContactKey& bodies,
                       const Point3& normal,
                       std::span<const ContactRecord> records);

  const SceneSurfaces& scene_;
  PatchMoments moments_;
  PatchSupports supports_;
  std::vector<std::size_t> order_, left_, next_left_, patch_, chosen_;
  std::vector<std::int32_t> slots_;    ///< of patches that are in use, of the current pair
  std::vector<ReportedContact> kept_;  ///< of the rigid bodies
};

}  // namespace tetwarp

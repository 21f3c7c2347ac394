/// @file known_hits.hpp
/// KnownHits: which hits of a detection no earlier detection of the step found.
#pragma once
#include <vector>

#include "host/collide/collision_surfaces.hpp"
#include "kernels/collide/pair_touch.hpp"

namespace tetwarp {

class KnownHits {
 public:
  /// @param surfaces  kept by the caller
  explicit KnownHits(const CollisionSurfaces& surfaces) : surfaces_(surfaces) {}

  /// Starts a step: no hit is known.
  void clear() { known_.clear(); }

  /// Adds the hits of a detection.
  /// @returns those that were not known, sorted; valid until the next call
  const std::vector<FeatureTouch>& add(View<const FeatureTouch> hits);

  /// Of the hits last added, those of two rigid bodies; valid until the next call.
  const std::vector<FeatureTouch>& of_rigid_bodies();

 private:
  const CollisionSurfaces& surfaces_;
  std::vector<FeatureTouch> known_;    ///< sorted
  std::vector<FeatureTouch> last_;     ///< the hits last added, sorted
  std::vector<FeatureTouch> results_;  ///< of the last call
};

}  // namespace tetwarp

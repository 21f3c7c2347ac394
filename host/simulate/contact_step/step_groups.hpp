/// @file step_groups.hpp
/// StepGroups: the fraction of a step that each body moves, so that nothing intersects, and which
/// bodies stop together.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <tetwarp/contact_tracker.hpp>

#include "host/base/disjoint_sets.hpp"
#include "host/collide/detector.hpp"
#include "host/simulate/contact_step/body_link.hpp"
#include "host/simulate/model/model.hpp"

namespace tetwarp {

/// A group is a contact island, or a scripted body or obstacle. All bodies of a group move the same
/// fraction of the step, at first 1. A hit on a body that stands still stops the other body's group
/// alone.
class StepGroups {
 public:
  /// @param surfaces  kept by the caller
  StepGroups(const Model& model, const CollisionSurfaces& surfaces);

  /// Starts a step: coupling islands, joined where contacts tie two of them; all fractions are 1.
  /// @param sleeping  bodies of contacts that are not solved
  void begin(const std::vector<TrackedContact>& contacts, std::span<const BodyLink> sleeping);

  /// Shortens the motion of groups with pairs that come too near, and joins the two groups of each.
  /// Call it until it returns false, each time with the hits of the motion of fractions().
  ///
  /// In the first rounds a group moves 0.9 of the way to its first hit, in later ones not at all.
  /// It ends: every later round stops at least one more group for good, and two that stand still do
  /// not hit.
  /// @param motion  of the hits
  /// @returns whether a fraction has changed
  bool stop(const std::vector<TouchingPair>& hits, const SurfaceMotion& motion);

  /// [bodies, then obstacles]
  const std::vector<double>& fractions() const { return fraction_; }
  double smallest_fraction() const;
  bool all_move() const { return smallest_fraction() == 1; }
  /// Contact islands.
  std::int64_t island_count();
  /// Contact islands that move less than the whole step.
  std::int64_t stopped_islands();

 private:
  bool can_move(std::int32_t body) const;
  void note_what_moves(const SurfaceMotion& motion);
  bool shorten(const TouchingPair& hit);
  void share_in_groups();
  std::int64_t islands_with_unknowns(bool only_stopped);

  const Model& model_;
  const CollisionSurfaces& surfaces_;
  DisjointSets coupling_islands_;  ///< [bodies, then obstacles]
  DisjointSets groups_;            ///< [bodies, then obstacles]
  std::vector<double> fraction_, next_;
  std::vector<std::uint8_t> moves_;  ///< with a fraction of 1
  int rounds_ = 0;
};

}  // namespace tetwarp

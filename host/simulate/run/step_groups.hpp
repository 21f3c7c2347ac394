/// @file step_groups.hpp
/// StepGroups: the fraction of a step that each body moves, so that nothing intersects, and which
/// bodies stop together.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <tetwarp/contact_tracker.hpp>

#include "host/collide/detector.hpp"
#include "host/simulate/model/model.hpp"
#include "host/simulate/run/island_sleep.hpp"

namespace tetwarp {

/// A group is a contact island, or a scripted body or obstacle. All bodies of a group move the same
/// fraction of the step, at first 1. Bodies that stand still are in no group's way: a hit on them
/// stops the other side alone.
class StepGroups {
 public:
  /// @param surfaces  kept by the caller
  StepGroups(const Model& model, const CollisionSurfaces& surfaces);

  /// Starts a step: coupling islands, joined where contacts tie two of them; all fractions are 1.
  /// @param sleeping  bodies of contacts that are not solved
  void begin(const std::vector<TrackedContact>& contacts, std::span<const BodyLink> sleeping);

  /// Shortens the ways of groups with pairs that come too near, and joins the two groups of each.
  /// Call it until it returns false, each time with the hits of the motion of fractions().
  ///
  /// The first rounds leave 0.9 of the way to the first hit, the later ones nothing. It ends: every
  /// later round stops at least one more group for good, and two that stand still do not hit.
  /// @param motion  of the hits
  /// @returns whether a fraction has changed
  bool stop(const std::vector<TouchingPair>& hits, const SurfaceMotion& motion);

  /// [bodies, then obstacles]
  const std::vector<double>& fractions() const { return fraction_; }
  double smallest_fraction() const;
  bool all_move() const { return smallest_fraction() == 1; }
  /// Contact islands, all and those that move a part of the step only.
  std::int64_t island_count() const;
  std::int64_t stopped_islands() const;

 private:
  std::int32_t root_of(std::int32_t body);
  bool join(std::int32_t a, std::int32_t b);
  void note_what_moves(const SurfaceMotion& motion);
  std::int32_t roots_with_unknowns(bool only_stopped) const;

  const Model& model_;
  const CollisionSurfaces& surfaces_;
  std::vector<std::int32_t> island_start_;  ///< [bodies, then obstacles] first body of the coupling
                                            ///< island, or the body itself
  std::vector<std::int32_t> parent_;        ///< [bodies, then obstacles]
  std::vector<double> fraction_, next_;
  std::vector<std::uint8_t> moves_;  ///< with a fraction of 1
  int rounds_ = 0;
};

}  // namespace tetwarp

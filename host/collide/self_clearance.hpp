/// @file self_clearance.hpp
/// SelfClearance: bodies that cannot touch themselves in a motion because they hardly deform.
#pragma once
#include <cstdint>
#include <vector>

#include "host/collide/collide_items.hpp"
#include "host/collide/collision_surfaces.hpp"

namespace tetwarp {

/// All features of a body that share no vertex were found to be farther apart than a clearance. As
/// long as no vertex has moved by more than u since then, beside a translation of the whole body,
/// features are farther apart than the clearance - 2 u: they are weighted means of vertices. So
/// detection leaves out pairs of a body with itself that it would find to be too far apart.
///
/// Measuring takes as long as a detection or two. A body that deforms too fast for it to pay is
/// measured ever more seldom. What is found never depends on this.
class SelfClearance {
 public:
  /// @param surfaces  kept by the caller
  /// @param is_used   false: no body is ever known to be clear
  SelfClearance(const CollisionSurfaces& surfaces, const CollideItems& items, bool is_used);

  /// Before a search: measures bodies that are not known to be clear in a motion, where due.
  /// @param motion   in memory of the host
  /// @param measure  (body, limit): the smallest distance of features of a body at the start of the
  ///                 motion that share no vertex, or the limit if all are farther apart [m]
  template <class Measure>
  void update(const MotionView& motion, double distance, const Measure& measure) {
    for (Entry& entry : entries_) {
      if (!is_due(entry, motion, distance)) continue;
      set_start(entry, motion);
      const double limit = limit_share * shortest_edge(entry, motion);
      if (limit - 2 * deformation(entry, motion) > distance) {
        entry.clearance = measure(entry.body, limit);
      }
      if (!is_clear(entry, motion, distance)) pause(entry);
    }
  }

  /// Bodies for a search: CollideItems::bodies, without touches_itself where a body stays farther
  /// apart from itself than a distance.
  const std::vector<CollideBody>& find(const MotionView& motion, double distance);
  /// Whether the bodies that the last find() knew to be clear are so in another motion.
  bool are_clear(const MotionView& motion, double distance) const;

 private:
  static constexpr double limit_share = 0.5;  // of the shortest edge
  static constexpr int most_pause = 64;
  static constexpr int least_uses = 4;

  /// A body that may touch itself.
  struct Entry {
    std::int32_t body = 0;
    std::vector<double> start;  ///< places of its vertices when the clearance was measured
    double clearance = 0;       ///< [m]; 0: not known
    bool is_left_out = false;   ///< by the last find()
    int uses = 0;               ///< updates for which the clearance has sufficed
    int pause = 0, wait = 0;    ///< updates until it is measured again
  };

  bool is_due(Entry& entry, const MotionView& motion, double distance);
  static void pause(Entry& entry);
  void set_start(Entry& entry, const MotionView& motion) const;
  double shortest_edge(const Entry& entry, const MotionView& motion) const;
  double deformation(const Entry& entry, const MotionView& motion) const;
  bool is_clear(const Entry& entry, const MotionView& motion, double distance) const;

  const CollisionSurfaces& surfaces_;
  std::vector<CollideBody> bodies_;
  std::vector<Entry> entries_;
};

}  // namespace tetwarp

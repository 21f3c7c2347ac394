/// @file contact_impulses.hpp
/// ContactImpulses: the impulses of contacts in a part of a step, summed over blocks and bodies.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include <tetwarp/contact_tracker.hpp>

#include "host/simulate/solve/contact_system.hpp"

namespace tetwarp {

/// The impulse of a contact on body a, in world axes.
/// @param impulse  its three components along the axes of the contact
Point3 world_impulse(const TrackedContact& contact, const double* impulse);

class ContactImpulses {
 public:
  /// Sets all sums to zero.
  /// @param body_count  bodies and obstacles
  void reset(std::size_t block_count, std::size_t body_count);
  /// Sets those on blocks and adds those on bodies.
  /// @param contacts  that `system` has solved
  void add_contacts(const std::vector<TrackedContact>& contacts, const ContactSystem& system);
  /// Adds an impulse on body a, and the opposite one on body b.
  void add_pair(std::size_t body_a, std::size_t body_b, const Point3& on_a);
  /// Adds an impulse on a block.
  void add_on_block(std::int32_t block, const Point3& impulse);

  /// [block_count] [N s, N m s]; of blocks with unknowns 0
  const std::vector<Point3>& on_blocks() const { return on_blocks_; }
  /// [bodies, then obstacles] [N s]
  const std::vector<Point3>& on_bodies() const { return on_bodies_; }

 private:
  std::vector<Point3> on_blocks_, on_bodies_;
};

}  // namespace tetwarp

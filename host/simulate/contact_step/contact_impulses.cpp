/// @file contact_impulses.cpp
/// Sums the impulses of contacts over the blocks and bodies that they act on.
#include "host/simulate/contact_step/contact_impulses.hpp"

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"

namespace tetwarp {

Point3 world_impulse(const TrackedContact& contact, const double* impulse) {
  Point3 sum{0, 0, 0};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    sum = plus(sum, times(impulse[axis], contact.axes[axis]));
  }
  return sum;
}

void ContactImpulses::reset(std::size_t block_count, std::size_t body_count) {
  on_blocks_.assign(block_count, {0, 0, 0});
  on_bodies_.assign(body_count, {0, 0, 0});
}

void ContactImpulses::add_contacts(const std::vector<TrackedContact>& contacts,
                                   const ContactSystem& system) {
  on_blocks_ = system.block_impulses();
  const double* impulse = system.solution().impulse.data();
  for (const TrackedContact& contact : contacts) {
    add_pair(index_of(contact.key.body_a), index_of(contact.key.body_b),
             world_impulse(contact, impulse));
    impulse += 3;
  }
}

void ContactImpulses::add_pair(std::size_t body_a, std::size_t body_b, const Point3& on_a) {
  on_bodies_[body_a] = plus(on_bodies_[body_a], on_a);
  on_bodies_[body_b] = minus(on_bodies_[body_b], on_a);
}

void ContactImpulses::add_on_block(std::int32_t block, const Point3& impulse) {
  on_blocks_[index_of(block)] = plus(on_blocks_[index_of(block)], impulse);
}

}  // namespace tetwarp

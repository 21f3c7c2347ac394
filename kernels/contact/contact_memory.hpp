/// @file contact_memory.hpp
/// Memory of a solve, for any executor: its unknowns, and work vectors of its methods.
#pragma once
#include <cstdint>

#include "kernels/contact/contact_methods.hpp"
#include "kernels/contact/contact_numbers.hpp"

namespace tetwarp {

/// Impulses and velocities of all islands, and the counters of FrozenContacts.
template <class Exec, class T>
struct StateMemory {
  template <class U>
  using Vector = typename Exec::template Vector<U>;

  Vector<T> impulse, velocity;            ///< r, u, [3 slots]
  Vector<T> body_velocity;                ///< v, [dofs]
  Vector<std::uint8_t> unchanged_visits;  ///< [slots], or empty: no contact is ever frozen
  Vector<std::int32_t> skipped_visits;    ///< as above

  /// Zero impulses and the velocities without them; no contact frozen.
  void reset(Exec& exec, const ContactNumbers<T>& numbers, bool freezes) {
    exec.make_zeros(impulse, numbers.free_velocity.size);
    exec.make_zeros(velocity, numbers.free_velocity.size);
    exec.copy("contact/setup", numbers.free_velocity, view_of(velocity));
    exec.make_zeros(body_velocity, numbers.body_free.size);
    exec.copy("contact/setup", numbers.body_free, view_of(body_velocity));
    exec.make_zeros(unchanged_visits, freezes ? numbers.constants.size : 0);
    exec.make_zeros(skipped_visits, freezes ? numbers.constants.size : 0);
  }

  ContactState<T> views() {
    return {view_of(impulse),          view_of(velocity),      view_of(body_velocity), {},
            view_of(unchanged_visits), view_of(skipped_visits)};
  }
};

/// Work vectors of ContactMethods. They are not initialized; a method accesses only its own part.
template <class Exec, class T>
class MethodMemory {
 public:
  MethodWork<T> reserve(std::int64_t slots) {
    const std::int64_t rows = 3 * slots, mixed = MethodWork<T>::columns * rows;
    weights_.reserve(rows);
    before_.reserve(rows);
    best_.reserve(rows);
    mixed_.reserve(mixed);
    return {weights_.view(rows), before_.view(rows), best_.view(rows), mixed_.view(mixed)};
  }

 private:
  template <class U>
  using Buffer = typename Exec::template Buffer<U>;

  Buffer<double> weights_;
  Buffer<T> before_, best_, mixed_;
};

}  // namespace tetwarp

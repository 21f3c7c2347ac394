/// @file memory.hpp
/// What the contact solver changes and works with, in memory of the host.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "host/contact/structure/system.hpp"
#include "kernels/contact/contact_methods.hpp"

namespace tetwarp {

/// Impulses and velocities; a solve starts from those without any impulse.
template <class T>
struct HostContactState {
  std::vector<T> impulse, velocity, body_velocity, defect;
  std::vector<std::uint8_t> unchanged_visits;
  std::vector<std::int32_t> skipped_visits;

  explicit HostContactState(const ContactSystem<T>& system)
      : impulse(system.free_velocity.size(), T(0)),
        velocity(system.free_velocity),
        body_velocity(system.body_free) {}

  ContactState<T> view() {
    return {view_of(impulse), view_of(velocity),         view_of(body_velocity),
            view_of(defect),  view_of(unchanged_visits), view_of(skipped_visits)};
  }
};

/// What methods work with. Only what they write is ever touched.
template <class T>
class HostMethodWork {
 public:
  explicit HostMethodWork(std::size_t slots)
      : slots_(static_cast<std::int64_t>(slots)),
        weights_(new double[3 * slots]),
        numbers_(new T[3 * slots * (MethodWork<T>::columns + 2)]),
        metric_(new ContactConstants<T>[slots]) {}

  MethodWork<T> view() const {
    const std::int64_t size = 3 * slots_;
    T* const numbers = numbers_.get();
    return {{weights_.get(), size},
            {numbers, size},
            {numbers + size, size},
            {numbers + 2 * size, MethodWork<T>::columns * size},
            {metric_.get(), slots_}};
  }

 private:
  std::int64_t slots_;
  std::unique_ptr<double[]> weights_;
  std::unique_ptr<T[]> numbers_;
  std::unique_ptr<ContactConstants<T>[]> metric_;
};

/// Measured residuals, all of them.
struct HostEventLog {
  std::vector<ContactEvent> events;

  void note(const ContactEvent& event) { events.push_back(event); }
};

}  // namespace tetwarp
